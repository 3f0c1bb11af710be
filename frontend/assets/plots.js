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

  /* --- the picture as a file: Plotly has PNG, here are SVG and CSV ----------------------------------------------- */
  const fileName = (gd) => ((gd._context.toImageButtonOptions || {}).filename || "slowdrift");

  function save(name, text, type) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  /* A row per point: name of the curve, then its coordinates, with the axes' titles and units as heads. */
  function csv(gd) {
    const quote = (value) => (/[",\n]/.test(String(value ?? "")) ? `"${String(value).replace(/"/g, '""')}"` : String(value ?? ""));
    const title = (trace, letter) => {
      const place = trace.type.endsWith("3d") ? (gd._fullLayout[trace.scene || "scene"] || {})[`${letter}axis`]
        : gd._fullLayout[(trace[`${letter}axis`] || letter).replace(letter, `${letter}axis`)];
      return (((place || {}).title || {}).text || letter).replace(/<[^>]*>/g, "");
    };
    const rows = [];
    let head = null;
    for (const trace of gd._fullData) {
      const letters = ["x", "y", "z"].filter((letter) => trace[letter] && trace[letter].length !== undefined);
      if (!letters.length) continue;
      const names = ["curve", ...letters.map((letter) => title(trace, letter))];
      if (!head || head.join() !== names.join()) rows.push((head = names).map(quote).join(","));
      const length = Math.max(...letters.map((letter) => trace[letter].length));
      for (let i = 0; i < length; i += 1) rows.push([trace.name, ...letters.map((letter) => trace[letter][i])].map(quote).join(","));
    }
    return `${rows.join("\r\n")}\r\n`;
  }

  const ICONS = { svg: "M3 3h14v14H3z M6 13l3-4 2 2 3-5 2 7z", csv: "M3 3h14v14H3z M3 8h14 M3 12h14 M8 3v14" };
  const icon = (path) => ({ width: 20, height: 20, path });
  const buttons = () => [
    { name: "svg", title: "Download plot as SVG", icon: icon(ICONS.svg), click: (gd) => window.Plotly.downloadImage(gd, { format: "svg", filename: fileName(gd), width: gd._fullLayout.width, height: gd._fullLayout.height }) },
    { name: "csv", title: "Download the data as CSV", icon: icon(ICONS.csv), click: (gd) => save(`${fileName(gd)}.csv`, csv(gd), "text/csv") },
  ];
  const equipped = (config) => ({ ...config, modeBarButtonsToAdd: [...((config || {}).modeBarButtonsToAdd || []), ...buttons()] });

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
      if (whole) return draw.call(plotly, target, { ...figure, data: seen(data), layout: seen(frame), config: equipped(figure.config) });
      return draw.call(plotly, target, seen(data), seen(frame), equipped(config));
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

  /* A table's text to the clipboard, tabs between, as a spreadsheet takes it. */
  document.addEventListener("click", async (event) => {
    const button = event.target.closest ? event.target.closest(".sd-copy-table") : null;
    const table = button && button.parentElement.querySelector("table");
    if (!table) return;
    const cell = (one) => one.innerText.trim().replace(/[\u2009\u202f]/g, "").replace(/\u2212/g, "-");
    const text = [...table.rows].map((row) => [...row.cells].map(cell).join("\t")).join("\n");
    try {
      await navigator.clipboard.writeText(text);
      button.textContent = "Copied";
    } catch (error) {
      button.textContent = "Not copied";
    }
    setTimeout(() => (button.textContent = "Copy"), 1500);
  });

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
