// @ts-check
/**
 * The shapes of what the API sends, as far as the page reads them. Types only.
 *
 * @typedef {{ symbol: string, display: string, scale: number }} Unit
 * @typedef {"queued" | "running" | "done" | "failed" | "cancelled" | "timed_out" | "out_of_memory"} State
 * @typedef {{ step?: number, steps?: number, fraction?: number, stage?: string, rate?: number | null,
 *   remaining?: [number, number] | null, simulated_time?: number | null }} Progress
 * @typedef {{ title?: string, detail?: string, remedy?: string }} Trouble
 * @typedef {{ id: string, parameters: Record<string, number>, state: State, progress?: Progress | null,
 *   error?: Trouble | null, attempt?: number }} RunItem
 * @typedef {{ id: string, kind: string, name: string, state: State, progress?: Progress | null,
 *   created: string, started?: string | null, ended?: string | null, error?: Trouble | string | null,
 *   priority?: number, source?: string | null, position?: number | null, estimated_start?: [string, string] | null, runs: RunItem[] }} Job
 * @typedef {Record<string, any>} Study
 * @typedef {{ steps?: number, unknowns?: number, seconds?: number, memory_bytes?: number,
 *   disk_bytes?: number, runs?: number, basis?: string }} Estimate
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
 * @typedef {{ name: string, peak: number, time: number, level: string }} CarComfort
 * @typedef {{ clause: string, levels: { name: string, limit: number }[], cars: CarComfort[],
 *   worst: CarComfort }} Comfort
 * @typedef {{ id: string, job: string, parameters: Record<string, number>, state: State,
 *   progress?: Progress | null, error?: Trouble | string | null,
 *   summary?: { comfort?: Comfort, facts?: Record<string, any>, peaks?: any, modes?: Mode[], unjudged?: string, timings?: Record<string, number>,
 *     versions?: Record<string, string> } | null, verdicts?: Verdict[] }} Run
 * @typedef {{ curve: string, channel: string, unit: string, minimum: number | null, minimum_time: number | null,
 *   maximum: number | null, maximum_time: number | null, contact_lost?: number }} TableRow
 * @typedef {{ data: any[], layout: any, table: TableRow[], summary: string }} Figure
 * @typedef {{ name: string, title: string, unit: Unit, group: string,
 *   place?: [number, number, number] | null }} Channel
 * @typedef {"json" | "png" | "svg" | "pdf" | "csv"} FigureFormat
 * @typedef {{ from?: number, to?: number, points?: number, channels?: string[], place?: string,
 *   variant?: string, theme?: string }} FigureQuery
 * @typedef {{ name: string, json: (query: FigureQuery, signal?: AbortSignal) => Promise<Figure>,
 *   url: (format: FigureFormat, query?: FigureQuery) => string,
 *   channels?: () => Promise<Channel[]>, channelUrl?: (channel: string) => string }} FigureSource
 *   where a chart's figure comes from; `channels` where curves can be chosen
 * @typedef {{ name: string, title: string, group?: string, axis?: string, needs_place?: boolean,
 *   variants?: { name: string, title: string }[] }} FigureItem
 * @typedef {{ quantity: string, unit: string, minimum: number, maximum: number,
 *   stops: [number, string][] }} ColourBar
 * @typedef {{ sequence: number, layer: string, point: [number, number, number],
 *   slab_point: number | null }} Picked
 * @typedef {{ position: [number, number, number], look_at: [number, number, number],
 *   fov: number | null }} CameraPose where somebody moved the camera [m]; field of view where it is not its
 *   preset's [rad]
 * @typedef {{ session: string, run: string, time: number, playing: boolean, rate: number, scale: number,
 *   layers: string[], camera: string, theme: string, available_layers: string[], last_time: number,
 *   frame_interval: number, done: boolean, clients: number, colour: string,
 *   smooth: boolean, available_colours: string[], colour_bar: ColourBar | null, mode: number, modal: boolean,
 *   picked: Picked | null, paused: string, pose: CameraPose | null }} ViewerState
 * @typedef {{ pointer: string, confidence: string, text: string }} Remark what to know of one figure
 * @typedef {{ name: string, source: string, confidence: string, remarks: Remark[], value: any }} LibraryEntry
 *   value is the part of a study
 * @typedef {LibraryEntry & { id: string, kind: string, built_in: boolean, created: string | null,
 *   changed: string | null }} LibraryItem
 * @typedef {{ id: string, job: string, name: string, kind: string, index: number, runs: number, state: State,
 *   parameters: Record<string, number>, has_histories: boolean }} ComparedRun
 * @typedef {{ pointer: string, unit: Unit | null, values: any[] }} ComparedInput
 * @typedef {{ name: string, group: string, unit: Unit | null, values: (number | null)[],
 *   changes: (number | null)[], remarks: string[] }} ComparedResult
 * @typedef {{ runs: ComparedRun[], inputs: ComparedInput[], results: ComparedResult[],
 *   channels: Channel[], remarks: string[] }} Comparison the first run is the baseline
 * @typedef {{ version: string, plotly_url: string, openapi_url?: string }} Meta
 * @typedef {{ cores: number, memory_bytes: number, memory_available_bytes: number, disk_free_bytes: number,
 *   engine: string, workers: number, running: number, queued: number, version: string, trouble: string }} Machine
 * @typedef {{ session: string, url: string }} ViewerSession
 */
export {};
