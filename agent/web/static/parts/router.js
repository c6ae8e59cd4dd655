// Addresses of the page and the screens that draw them; links work as links do (new tab, back, bookmark).
import { useEffect, useState } from "./html.js";

/** ``/loops/{name}`` against ``/loops/FIC101`` gives {name: "FIC101"}; null where it does not fit. */
export function match(pattern, path) {
  const wanted = pattern.split("/");
  const given = path.split("/");
  if (wanted.length !== given.length) return null;
  const params = {};
  for (let k = 0; k < wanted.length; k++) {
    if (wanted[k].startsWith("{")) params[wanted[k].slice(1, -1)] = decodeURIComponent(given[k]);
    else if (wanted[k] !== given[k]) return null;
  }
  return params;
}

export function navigate(address, replace = false) {
  history[replace ? "replaceState" : "pushState"](null, "", address);
  dispatchEvent(new Event("slipjump:address"));
  if (!replace) scrollTo(0, 0);
}

/** Follows links to this page without loading it anew. */
export function followLinks() {
  addEventListener("click", (event) => {
    const link = event.target.closest?.("a[href]");
    if (!link || event.defaultPrevented || event.button || event.metaKey || event.ctrlKey || event.shiftKey) return;
    if (link.origin !== location.origin || link.target || link.hasAttribute("download")) return;
    if (link.hash && link.pathname === location.pathname && link.search === location.search) return;
    event.preventDefault();
    navigate(link.pathname + link.search + link.hash);
  });
}

export function useAddress() {
  const now = () => location.pathname + location.search;
  const [address, set] = useState(now());
  useEffect(() => {
    const changed = () => set(now());
    addEventListener("popstate", changed);
    addEventListener("slipjump:address", changed);
    return () => {
      removeEventListener("popstate", changed);
      removeEventListener("slipjump:address", changed);
    };
  }, []);
  return address;
}
