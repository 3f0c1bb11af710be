/* Runs in the head, before anything is drawn: the scheme that the reader chose, else the system's (Mantine keeps it after);
   and Plotly, which is large, is asked for at once where a page will want it. */
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
  const plotly = document.currentScript && document.currentScript.dataset.plotly;
  if (plotly && /\/(runs\/|shared\/|compare|studies\/|new|data\/)/.test(window.location.pathname)) {
    const link = document.createElement("link");
    Object.assign(link, { id: "expect-plotly", rel: "preload", as: "script", href: plotly });
    document.head.appendChild(link);
  }
})();
