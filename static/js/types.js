// @ts-check
/**
 * The shapes of what the API sends, as far as the page reads them. Types only.
 *
 * @typedef {{ symbol: string, display: string, scale: number }} Unit
 * @typedef {"queued" | "running" | "done" | "failed" | "cancelled" | "timed_out" | "out_of_memory"} State
 * @typedef {{ step?: number, steps?: number, fraction?: number, stage?: string, rate?: number | null,
 *   remaining?: [number, number] | null, simulated_time?: number | null }} Progress
 * @typedef {{ title?: string, detail?: string, remedy?: string }} Trouble
 * @typedef {{ id: string, parameters: Record<string, number>, state: State, progress?: Progress | null }} RunItem
 * @typedef {{ id: string, kind: string, name: string, state: State, progress?: Progress | null,
 *   created: string, started?: string | null, ended?: string | null, error?: Trouble | string | null,
 *   position?: number | null, estimated_start?: [string, string] | null, runs: RunItem[] }} Job
 * @typedef {Record<string, any>} Study
 * @typedef {{ steps?: number, unknowns?: number, seconds?: number, memory_bytes?: number,
 *   disk_bytes?: number, runs?: number }} Estimate
 * @typedef {{ name: string, title: string, description: string, kind?: string, study: Study,
 *   estimate?: Estimate | null, notes?: string[] }} Template
 * @typedef {{ pointer: string, value?: unknown, reason: string, remedy?: string }} Finding
 * @typedef {{ value: any, unit?: Unit | string, title?: string }} Quantity
 * @typedef {{ errors: Finding[], warnings: Finding[], derived: Record<string, Quantity>,
 *   estimate: Estimate | null }} Report
 * @typedef {{ name: string, x: number, y: number, z: number }} Place
 * @typedef {{ value: number, time: number, place: Place }} Peak
 * @typedef {{ rule: string, clause: string, title: string, limit: number, value: number, unit: string,
 *   exceeds: boolean, place: Place, time: number, speed: number, filter: string, cut_off: number,
 *   cut_off_origin: string, statement: string, notes: string[], raw: Peak,
 *   scope: { train: string, speed: number, irregularity: string, mesh_level: string },
 *   points: { name: string, filtered: Peak, raw: Peak }[],
 *   spans: { number: number, judged: boolean, filtered: Peak, raw: Peak, remark: string }[] }} Verdict
 * @typedef {{ number: number, frequency: number, damping: number, name: string, assurance: number }} Mode
 *   frequency in Hz, damping and assurance as ratios
 * @typedef {{ items: Job[], next?: string | null }} JobPage
 * @typedef {{ id: string, job: string, parameters: Record<string, number>, state: State,
 *   progress?: Progress | null, error?: Trouble | string | null,
 *   summary?: { facts?: Record<string, any>, peaks?: any, modes?: Mode[], unjudged?: string, timings?: Record<string, number>,
 *     versions?: Record<string, string> } | null, verdicts?: Verdict[] }} Run
 * @typedef {{ curve: string, channel: string, unit: string, minimum: number | null, minimum_time: number | null,
 *   maximum: number | null, maximum_time: number | null, contact_lost?: number }} TableRow
 * @typedef {{ data: any[], layout: any, table: TableRow[], summary: string }} Figure
 * @typedef {{ name: string, title: string, unit: Unit, group: string,
 *   place?: [number, number, number] | null }} Channel
 * @typedef {{ version: string, plotly_url: string, openapi_url?: string }} Meta
 * @typedef {{ session: string, url: string }} ViewerSession
 */
export {};
