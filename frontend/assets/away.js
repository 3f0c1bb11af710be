/* The server is away: say so, ask now and again, and tell everybody when it is back. Every request of the page passes here. */
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

  window.fetch = async (...args) => {
    try {
      return await plain(...args);
    } catch (error) {
      if (error.name !== "AbortError" && !away && document.visibilityState !== "hidden") {
        away = true;
        show();
        setTimeout(ask, ASK_MS);
      }
      throw error;
    }
  };
})();
