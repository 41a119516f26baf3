/** Takes a file that is dropped anywhere on the page; without it the file would replace the page. */

import { setAttribute } from "/web/js/base/dom.js";

/** Call `take(file)` for each file; meanwhile the body has `data-dragging`. */
export function listenForFiles(take) {
  const carriesFile = ({ dataTransfer }) => dataTransfer?.types.includes("Files");
  const mark = (isDragging) => setAttribute(document.body, "data-dragging", isDragging);
  document.addEventListener("dragover", (event) => {
    if (!carriesFile(event)) return;
    event.preventDefault();
    mark(true);
  });
  document.addEventListener("dragleave", ({ relatedTarget }) => relatedTarget === null && mark(false));
  document.addEventListener("drop", (event) => {
    mark(false);
    if (!carriesFile(event)) return;
    event.preventDefault();
    const [file] = event.dataTransfer.files;
    if (file) take(file);
  });
}
