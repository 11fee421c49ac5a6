// Light or dark, before anything is drawn: as chosen in this browser, else as the machine says.
(() => {
  "use strict";
  const KEPT = "torsionbook.theme", dark = matchMedia("(prefers-color-scheme: dark)");
  const chosen = () => { try { return localStorage.getItem(KEPT) || ""; } catch { return ""; } };
  const draw = () => { document.documentElement.dataset.theme = chosen() || (dark.matches ? "dark" : "light"); };
  draw();
  dark.addEventListener("change", draw);
  addEventListener("DOMContentLoaded", () => {
    const choice = document.getElementById("theme");
    choice.value = chosen();
    choice.addEventListener("change", () => {
      try { localStorage.setItem(KEPT, choice.value); } catch { /* for this page only */ }
      document.documentElement.dataset.theme = choice.value || (dark.matches ? "dark" : "light");
    });
  });
})();
