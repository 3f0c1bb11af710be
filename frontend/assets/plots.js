/* Pictures follow the scheme. Figures come in the light palette; this is the one place that knows its dark twin. */
(function () {
  "use strict";
  const TWINS = {
    "#212529": "#e3e6e9", "#5c636a": "#a9b0b7", "#e3e7eb": "#3d4349", "#ffffff": "#242424", "#c4cad0": "#5d646b",
    "#000000": "#f4f5f6", "#0072b2": "#4ba6e0", "#d55e00": "#f0803c", "#009e73": "#2cc295", "#495057": "#adb5bd", "#c8b68f": "#8d7d58",
  };
  const LARGE = new Set(["x", "y", "z", "i", "j", "k", "customdata", "meta", "text", "ids"]);
  const root = document.documentElement;
  const dark = () => root.getAttribute("data-mantine-color-scheme") === "dark";
  const sources = new WeakMap(); // element -> [data, layout] in the light palette

  const colour = (text) => {
    const twin = TWINS[text.toLowerCase()];
    if (twin) return twin;
    const parts = /^rgba\((\d+),\s*(\d+),\s*(\d+),\s*([\d.]+)\)$/.exec(text);
    if (!parts) return text;
    const hex = "#" + parts.slice(1, 4).map((n) => Number(n).toString(16).padStart(2, "0")).join("");
    const found = TWINS[hex];
    return found ? `rgba(${[1, 3, 5].map((i) => parseInt(found.slice(i, i + 2), 16)).join(",")},${parts[4]})` : text;
  };

  function twin(value, key) {
    if (typeof value === "string") return value[0] === "#" || value.startsWith("rgba(") ? colour(value) : value;
    if (!value || typeof value !== "object" || ArrayBuffer.isView(value) || LARGE.has(key)) return value;
    if (Array.isArray(value)) return value.length > 64 ? value : value.map((item) => twin(item));
    const made = {};
    for (const name of Object.keys(value)) made[name] = twin(value[name], name);
    return made;
  }

  const seen = (value) => (dark() ? twin(value) : value);

  function wrap(plotly) {
    if (!plotly || plotly.slowdrift) return plotly;
    const { react, newPlot, restyle } = plotly;
    const through = (draw) => (target, figure, layout, config) => {
      const element = typeof target === "string" ? document.getElementById(target) : target;
      const whole = figure && !Array.isArray(figure);
      const data = whole ? figure.data : figure;
      const frame = whole ? figure.layout : layout;
      sources.set(element, [data, frame]);
      if (whole) return draw.call(plotly, target, { ...figure, data: seen(data), layout: seen(frame) });
      return draw.call(plotly, target, seen(data), seen(frame), config);
    };
    plotly.react = through(react);
    plotly.newPlot = through(newPlot);
    plotly.slowdrift = { react, restyle };
    return plotly;
  }

  /* The scheme changed: the same picture, the same zoom, other colours. */
  function repaint() {
    for (const element of document.querySelectorAll(".js-plotly-plot")) {
      const source = sources.get(element);
      if (!source || !window.Plotly) continue;
      const frame = { ...source[1] };
      for (const [name, full] of Object.entries(element._fullLayout || {})) {
        if (/^[xy]axis\d*$/.test(name) && full.range) frame[name] = { ...frame[name], range: [...full.range], autorange: false };
        if (/^scene\d*$/.test(name) && full.camera) frame[name] = { ...frame[name], camera: full.camera };
      }
      window.Plotly.slowdrift.react.call(window.Plotly, element, seen(source[0]), seen(frame), element._context);
    }
  }

  let held = wrap(window.Plotly);
  Object.defineProperty(window, "Plotly", { configurable: true, get: () => held, set: (value) => (held = wrap(value)) });
  new MutationObserver(repaint).observe(root, { attributeFilter: ["data-mantine-color-scheme"] });

  /* Paper is white: print in the light scheme. */
  let before = null;
  window.addEventListener("beforeprint", () => {
    before = root.getAttribute("data-mantine-color-scheme");
    root.setAttribute("data-mantine-color-scheme", "light");
  });
  window.addEventListener("afterprint", () => before && root.setAttribute("data-mantine-color-scheme", before));

  /* Plotly under an address that names its version, so that a browser may keep it for good. */
  document.addEventListener("DOMContentLoaded", () => {
    const config = document.getElementById("_dash-config");
    const version = config && JSON.parse(config.textContent).plotly_version;
    if (version && window._dashPlotlyJSURL && !window._dashPlotlyJSURL.includes("?")) window._dashPlotlyJSURL += `?v=${version}`;
  });
  window.slowdrift = Object.assign(window.slowdrift || {}, {
    expectPlotly() {
      if (window.Plotly || document.getElementById("expect-plotly") || !window._dashPlotlyJSURL) return;
      const link = document.createElement("link");
      Object.assign(link, { id: "expect-plotly", rel: "preload", as: "script", href: window._dashPlotlyJSURL });
      document.head.appendChild(link);
    },
  });
})();
