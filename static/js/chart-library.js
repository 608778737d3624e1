// @ts-check
/** plotly.js, loaded once and only when a chart is first shown. */

/** @type {Promise<any> | null} */
let loading = null;

/**
 * @param {string} address of plotly.js, as the server says
 * @returns {Promise<any>}
 */
export function chartLibrary(address) {
  loading ??= new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = address;
    script.onload = () => resolve(/** @type {any} */ (window).Plotly);
    script.onerror = () => {
      loading = null;
      script.remove();
      reject(new Error("The chart library did not load."));
    };
    document.head.append(script);
  });
  return loading;
}
