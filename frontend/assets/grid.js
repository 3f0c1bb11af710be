/* The runs grid: how cells look, and which columns fit. */
(function () {
  "use strict";
  const functions = (window.dashAgGridFunctions = window.dashAgGridFunctions || {});
  const cells = (window.dashAgGridComponentFunctions = window.dashAgGridComponentFunctions || {});
  const h = (...args) => window.React.createElement(...args);
  const FINAL = ["succeeded", "failed", "cancelled"];

  functions.runsTheme = (theme) =>
    theme.withParams({
      fontFamily: "inherit", headerFontWeight: 600, accentColor: "var(--sd-link)", wrapperBorderRadius: 4, cellTextColor: "var(--sd-ink)",
      backgroundColor: "var(--sd-paper)", foregroundColor: "var(--sd-ink)", borderColor: "var(--sd-line)", headerBackgroundColor: "var(--sd-soft)",
      rowHoverColor: "var(--sd-soft)", headerTextColor: "var(--sd-ink)", browserColorScheme: "inherit",
      columnBorder: false, cellHorizontalPadding: 12,
    });
  functions.runAnalyses = (params) => (params.value || []).map((name) => name.replace(/_/g, " ")).join(", ");
  /* The reader's own clock, the order of the parts that nobody can misread. */
  functions.runMoment = (params) => {
    if (!params.value) return "–";
    const when = new Date(params.value);
    const two = (n) => String(n).padStart(2, "0");
    const day = `${when.getFullYear()}-${two(when.getMonth() + 1)}-${two(when.getDate())}`;
    return `${day} ${two(when.getHours())}:${two(when.getMinutes())}:${two(when.getSeconds())}`;
  };
  functions.runSeconds = (params) => {
    const run = params.data;
    return run.started_at && run.finished_at ? (Date.parse(run.finished_at) - Date.parse(run.started_at)) / 1000 : null;
  };
  functions.runDuration = (params) => {
    const value = params.value;
    if (value === null || value === undefined) return "–";
    if (value < 10) return `${value.toFixed(1)} s`;
    if (value < 60) return `${Math.round(value)} s`;
    return `${Math.floor(value / 60)} min ${String(Math.round(value % 60)).padStart(2, "0")} s`;
  };
  /* Which columns there is room for: again with new rows and with each new width of the window. */
  async function fit() {
    const box = document.getElementById("runs-grid");
    if (!box || !window.dash_ag_grid) return;
    const api = await window.dash_ag_grid.getApiAsync("runs-grid");
    const width = box.clientWidth;
    if (!width || api.isDestroyed()) return;
    api.setColumnsVisible(["analyses"], width >= 900);
    api.setColumnsVisible(["created_at"], width >= 640);
    api.setColumnsVisible(["duration"], width >= 760);
    const small = width < 480;
    api.setColumnWidths([{ key: "state", newWidth: small ? 122 : 190 }, { key: "action", newWidth: small ? 90 : 96 }]);
  }
  let resizing = null;
  window.addEventListener("resize", () => {
    clearTimeout(resizing);
    resizing = setTimeout(fit, 100);
  });
  window.dash_clientside = window.dash_clientside || {};
  window.dash_clientside.slowdrift = Object.assign(window.dash_clientside.slowdrift || {}, {
    fitRuns: () => {
      setTimeout(fit, 0);
      return Date.now();
    },
  });

  /* A link that changes the page without loading it again. */
  cells.RunLink = (props) => {
    const base = window.location.pathname.replace(/\/?$/, "/");
    const href = `${base}runs/${props.data.id}`;
    const go = (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      window.history.pushState({}, "", href);
      window.dispatchEvent(new CustomEvent("_dashprivate_pushstate"));
      window.scrollTo(0, 0);
    };
    return h("a", { href, onClick: go, className: "sd-run-link" }, props.value || "run");
  };

  cells.RunState = (props) => {
    const run = props.data;
    const badge = h("span", { className: `sd-badge sd-badge-${run.state}` }, run.state);
    if (FINAL.includes(run.state)) {
      return h("span", { title: run.reason || "", className: "sd-run-state" }, badge);
    }
    const percent = Math.round(100 * (run.progress || 0));
    const bar = h(
      "span",
      { className: "sd-bar", role: "progressbar", "aria-valuenow": percent, "aria-valuemin": 0, "aria-valuemax": 100, "aria-label": "progress" },
      h("span", { style: { width: `${percent}%` } }),
    );
    return h("span", { title: run.message || "", className: "sd-run-state" }, badge, bar, h("span", { className: "sd-percent" }, `${percent} %`));
  };

  cells.RunAction = (props) => {
    const run = props.data;
    if (run.state === "cancelling") return null;
    const action = FINAL.includes(run.state) ? "delete" : "cancel";
    const text = action === "delete" ? "Delete" : "Cancel";
    const say = () => props.setData({ action, id: run.id, at: Date.now() });
    return h("button", { type: "button", className: `sd-row-button sd-row-${action}`, onClick: say, "aria-label": `${text} run ${run.case_name}` }, text);
  };
})();
