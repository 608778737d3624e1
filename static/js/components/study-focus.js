// @ts-check
/** Where the focus is in a form: it stays when the inputs are drawn anew, and no fold hides it. */

/** Where the focus is: at which input, cell or library. @param {HTMLElement} form */
export function focusOf(form) {
  const active = document.activeElement;
  if (!(active instanceof HTMLElement) || !form.contains(active)) return null;
  const place = active.closest("[data-pointer]")?.getAttribute("data-pointer");
  return { cell: active.dataset.cell, place, library: active.closest("tb-library-choice")?.closest("section")?.id };
}

/**
 * Puts it there again, once the inputs are drawn anew.
 *
 * @param {HTMLElement} form
 * @param {ReturnType<typeof focusOf>} focused
 */
export function refocus(form, focused) {
  if (!focused) return;
  const { cell, place, library } = focused;
  const target = cell
    ? form.querySelector(`[data-cell="${CSS.escape(cell)}"]`)
    : place
      ? form.querySelector(`[data-pointer="${CSS.escape(place)}"]`)
      : library && form.querySelector(`#${CSS.escape(library)}`); // its list is read again first
  /** @type {HTMLElement | null} */ (target || null)?.focus();
}

/** Opens every fold around an element. @param {HTMLElement} element */
export function unfold(element) {
  for (let folded = element.closest("details"); folded; folded = folded.parentElement?.closest("details") ?? null) folded.open = true;
}
