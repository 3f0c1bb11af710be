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
  /* What a cell depends on, so that the grid draws it again when any of it changes. */
  functions.runName = ({ data }) => [data.name || data.case_name, data.pinned ? "pinned" : "", ...(data.tags || [])].filter(Boolean).join(", ");
  functions.runProgress = ({ data }) => [data.state, data.progress, data.eta_seconds, data.message].join(" ");
  functions.runAnalyses = ({ data }) => (data.analyses || []).map((name) => name.replace(/_/g, " ")).join(", ");
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
  const FROM = { analyses: 1080, created_by: 1180, duration: 940, created_at: 700 };
  let fitted = {}; // the grid and the width that the columns were chosen for: choosing again draws every cell anew
  async function fit() {
    const box = document.getElementById("runs-grid");
    if (!box || !window.dash_ag_grid) return;
    const api = await window.dash_ag_grid.getApiAsync("runs-grid");
    const width = box.clientWidth;
    if (!width || api.isDestroyed() || (fitted.api === api && fitted.width === width)) return;
    fitted = { api, width };
    for (const [column, least] of Object.entries(FROM)) api.setColumnsVisible([column], width >= least);
    const small = width < 480;
    api.setColumnWidths([{ key: "state", newWidth: small ? 112 : 210 }, { key: "action", newWidth: small ? 92 : 262 }]);
    api.setGridOption("rowSelection", { mode: "multiRow", checkboxes: !small, headerCheckbox: false, enableClickSelection: false });
    document.getElementById("runs-box").classList.toggle("sd-runs-small", small);
  }
  let resizing = null;
  window.addEventListener("resize", () => {
    clearTimeout(resizing);
    resizing = setTimeout(fit, 100);
  });

  /* The filters in one place and in the address, so that a link opens the same list. */
  function filters(q, state, tag, since, sort, pinned, before) {
    const kept = before && before.study ? { study: before.study } : {};
    const made = { q, state: (state || []).join(","), tag, since, sort: sort === "created" ? sort : "", pinned: pinned ? "true" : "", ...kept };
    const chosen = Object.fromEntries(Object.entries(made).filter(([, value]) => value));
    const query = new URLSearchParams(chosen).toString();
    window.history.replaceState(window.history.state, "", window.location.pathname + (query ? `?${query}` : ""));
    return JSON.stringify(chosen) === JSON.stringify(before) ? window.dash_clientside.no_update : chosen;
  }

  /* Which page of the list to show; the first one of other filters. */
  function turnPage(newer, older, chosen, at, trail) {
    const asked = window.dash_clientside.callback_context.triggered.map((one) => one.prop_id.split(".")[0]);
    let to = at;
    if (asked.includes("runs-filters")) to = 0;
    else if (asked.includes("runs-newer")) to = Math.max(0, at - 1);
    else if (asked.includes("runs-older") && at + 1 < trail.length) to = at + 1;
    return to === at ? window.dash_clientside.no_update : to;
  }

  const ended = (rows) => (rows || []).filter((run) => run.state === "succeeded" && run.kind !== "hydrodynamics");
  const comparable = (rows) => {
    const count = ended(rows).length;
    return [count < 1 || count > 6, count ? `Compare ${count}` : "Compare"];
  };
  function go(href) {
    window.history.pushState({}, "", href);
    window.dispatchEvent(new CustomEvent("_dashprivate_pushstate"));
    window.scrollTo(0, 0);
  }
  const compareRuns = (clicks, rows, prefix) => {
    if (clicks) go(`${prefix}compare?runs=${ended(rows).map((run) => run.id).join(",")}`);
    return clicks || 0;
  };

  window.dash_clientside = window.dash_clientside || {};
  window.dash_clientside.slowdrift = Object.assign(window.dash_clientside.slowdrift || {}, {
    filters, turnPage, comparable, compareRuns,
    fitRuns: () => {
      setTimeout(fit, 0);
      return Date.now();
    },
  });

  /* A link that changes the page without loading it again. */
  cells.RunLink = (props) => {
    const base = window.location.pathname.replace(/\/?$/, "/");
    const run = props.data;
    const href = run.kind === "hydrodynamics" ? `${base}data?job=${run.id}` : `${base}runs/${run.id}`;
    const follow = (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return;
      event.preventDefault();
      go(href);
    };
    const tags = (run.tags || []).slice(0, 4).map((tag) => h("span", { key: tag, className: "sd-tag" }, tag));
    const pin = run.pinned ? h("span", { title: "Pinned: its results stay", className: "sd-pin", role: "img", "aria-label": "pinned" }, "★") : null;
    return h("span", { className: "sd-run-name" },
      h("a", { href, onClick: follow, className: "sd-run-link" }, run.name || run.case_name || "run"), pin, ...tags);
  };

  const left = (seconds) => {
    if (seconds === null || seconds === undefined) return "";
    if (seconds < 60) return ` · ${Math.max(1, Math.round(seconds))} s left`;
    return seconds < 5400 ? ` · ${Math.round(seconds / 60)} min left` : ` · ${(seconds / 3600).toFixed(1)} h left`;
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
    return h("span", { title: run.message || "", className: "sd-run-state" }, badge, bar, h("span", { className: "sd-percent" }, `${percent} %${left(run.eta_seconds)}`));
  };

  cells.RunAction = (props) => {
    const run = props.data;
    const name = run.name || run.case_name;
    const say = (action) => () => props.setData({ action, id: run.id, at: Date.now() });
    const button = (action, text, more) =>
      h("button", { key: action, type: "button", className: `sd-row-button sd-row-${action} ${more || ""}`, onClick: say(action), "aria-label": `${text} run ${name}` }, text);
    const base = window.location.pathname.replace(/\/?$/, "/");
    const copy = run.case_id
      ? h("a", { key: "copy", className: "sd-row-button sd-wide", href: `${base}new?run=${run.id}`, "aria-label": `Edit run ${name} as new`,
          onClick: (event) => { event.preventDefault(); go(`${base}new?run=${run.id}`); } }, "Edit")
      : null;
    if (run.state === "cancelling") return h("span", { className: "sd-row-buttons" }, copy);
    if (!FINAL.includes(run.state)) return h("span", { className: "sd-row-buttons" }, button("cancel", "Cancel"), copy);
    return h("span", { className: "sd-row-buttons" }, run.case_id ? button("rerun", "Rerun", "sd-wide") : null, copy,
      button("rename", "Tag", "sd-wide"), button("delete", "Delete"));
  };
})();
