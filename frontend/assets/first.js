/* Runs in the head, before anything is drawn: the scheme that the reader chose, else the system's. Mantine keeps it after. */
(function () {
  "use strict";
  let kept = null;
  try {
    kept = localStorage.getItem("mantine-color-scheme-value");
  } catch (error) {
    /* storage is closed to us: follow the system */
  }
  const dark = kept === "dark" || (kept !== "light" && window.matchMedia("(prefers-color-scheme: dark)").matches);
  document.documentElement.setAttribute("data-mantine-color-scheme", dark ? "dark" : "light");
})();
