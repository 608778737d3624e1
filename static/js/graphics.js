// @ts-check
/** What this browser can draw in three dimensions, and at whose cost. */

/** @type {"none" | "software" | "hardware" | undefined} */
let known;

/** How this browser draws 3D. Asked once: a browser grants few drawing contexts. */
export function webGraphics() {
  if (known) return known;
  const context = document.createElement("canvas").getContext("webgl2");
  const details = context?.getExtension("WEBGL_debug_renderer_info");
  const renderer = details ? String(context?.getParameter(details.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  if (!context) known = "none";
  else known = /llvmpipe|softpipe|swiftshader|software/i.test(renderer) ? "software" : "hardware";
  return known;
}
