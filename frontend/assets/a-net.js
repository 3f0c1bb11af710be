/* Every request of the page passes here. The server is away: say so, ask now and again, tell everybody when it is back.
   A page opened by a share link: its callbacks say by which, and what it reads is behind that link. */
(function () {
  "use strict";
  const ASK_MS = 1500;
  const plain = window.fetch.bind(window);
  let away = false;

  function show() {
    const said = document.getElementById("sd-away");
    if (said) said.hidden = !away;
  }

  async function ask() {
    try {
      const answer = await plain("/healthz", { cache: "no-store" });
      if (answer.ok) {
        away = false;
        show();
        window.dispatchEvent(new CustomEvent("slowdrift:back"));
        return;
      }
    } catch (error) {
      /* still away */
    }
    setTimeout(ask, ASK_MS);
  }

  const token = () => (/\/shared\/([A-Za-z0-9_.-]+)/.exec(window.location.pathname) || [])[1];

  window.fetch = async (what, how) => {
    const link = token();
    if (link && String(what.url || what).includes("_dash-update-component")) {
      const headers = new Headers((how || {}).headers);
      headers.set("Slowdrift-Share", link);
      how = { ...how, headers };
    }
    try {
      return await plain(what, how);
    } catch (error) {
      if (error.name !== "AbortError" && !away && document.visibilityState !== "hidden") {
        away = true;
        show();
        setTimeout(ask, ASK_MS);
      }
      throw error;
    }
  };

  window.slowdrift = Object.assign(window.slowdrift || {}, { api: () => (token() ? `/api/v1/shared/${token()}` : "/api/v1") });
})();
