// Light, dark, or as the system says.
import { html, useState } from "./html.js";

const NEXT = { system: "light", light: "dark", dark: "system" };
const SIGN = { system: "◐", light: "○", dark: "●" };

export const isDark = () => {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
};

export function ThemeButton() {
  const [theme, set] = useState(document.documentElement.dataset.theme ?? "system");
  const turn = () => {
    const next = NEXT[theme];
    if (next === "system") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = next;
    try {
      if (next === "system") localStorage.removeItem("slipjump.theme");
      else localStorage.setItem("slipjump.theme", next);
    } catch { /* storage is off: the choice lasts until the page is closed */ }
    set(next);
    dispatchEvent(new Event("slipjump:theme"));
  };
  return html`<button type="button" class="theme" onClick=${turn} aria-label=${`Theme: ${theme}. Change to ${NEXT[theme]}`}>
    <span aria-hidden="true">${SIGN[theme]}</span> <span class="wide">${theme}</span></button>`;
}
