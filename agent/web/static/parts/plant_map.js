// The plant as a map: each area as large as it has loops, each loop a mark in it.
import { get } from "./api.js";
import { html, useEffect, useRef, useState } from "./html.js";
import { GROUPS, Shape } from "./marks.js";

const AGAIN = 5000; // ms
const TALL = 560; // px
const LOUD = new Set(["sticks", "suspected", "tight_tuning", "disturbance"]);

export function PlantMap({ choose }) {
  const [areas, set] = useState(null);
  const [width, setWidth] = useState(0);
  const place = useRef(null);
  useEffect(() => {
    const stop = new AbortController();
    const load = () => get("/api/work-list/map", stop.signal).then(set, () => {});
    load();
    const timer = setInterval(load, AGAIN);
    const observer = new ResizeObserver(() => setWidth(place.current?.clientWidth ?? 0));
    observer.observe(place.current);
    return () => {
      stop.abort();
      clearInterval(timer);
      observer.disconnect();
    };
  }, []);
  const sorted = [...(areas ?? [])].sort((a, b) => b.loops.length - a.loops.length);
  const loops = sorted.reduce((sum, each) => sum + each.loops.length, 0);
  const wide = Math.min(TALL, 200 + 6 * loops);
  const height = width < 500 ? Math.max(wide, 130 * sorted.length) : wide;
  const boxes = width ? squarified(sorted.map((each) => each.loops.length), 0, 0, width, height) : [];
  return html`<div class="plant-map" ref=${place} style=${{ height: `${height}px` }}>
    ${sorted.map((each, k) => boxes[k] && html`<${Area} key=${each.area} area=${each} box=${boxes[k]} choose=${choose} />`)}
  </div>`;
}

function Area({ area, box, choose }) {
  const [x, y, w, h] = box;
  const counts = {};
  for (const [, group] of area.loops) counts[group] = (counts[group] ?? 0) + 1;
  const text = Object.entries(GROUPS).filter(([group]) => counts[group]).map(([group, words]) => `${counts[group]} ${words.toLowerCase()}`).join(", ");
  const room = Math.floor(Math.sqrt(((w - 18) * (h - 46)) / area.loops.length)) - 3;
  const size = Math.max(5, Math.min(room, 30));
  const named = room > 78;
  return html`<section class="area" style=${{ left: `${x}px`, top: `${y}px`, width: `${w - 6}px`, height: `${h - 6}px` }} aria-label=${`Area ${area.area}: ${text}`}>
    <button type="button" class="area-name" onClick=${() => choose(area.area)}>${area.area} <span class="count">${area.loops.length}</span></button>
    <div class="marks">${area.loops.map(([name, group, stale]) => html`<a key=${name} class=${`mark ${LOUD.has(group) ? "loud" : ""} ${group} ${named ? "named" : ""}`} tabindex=${named ? 0 : -1}
      href=${`/loops/${encodeURIComponent(name)}`} title=${`${name}: ${GROUPS[group]}${stale ? ", stale data" : ""}`}>
      <${Shape} group=${stale ? "stale" : group} size=${named ? 16 : size} /><span class=${named ? "" : "unseen"}>${name}</span></a>`)}</div>
  </section>`;
}

/** Rectangles of the given sizes, close to squares (Bruls, Huizing and van Wijk, 2000): [x, y, width, height] each. */
export function squarified(sizes, x, y, width, height) {
  const total = sizes.reduce((sum, each) => sum + each, 0);
  if (!total) return [];
  const boxes = [];
  const areas = sizes.map((each) => (each * width * height) / total);
  let first = 0;
  while (first < areas.length) {
    const side = Math.min(width, height);
    let count = 1;
    while (first + count < areas.length && worst(areas.slice(first, first + count + 1), side) <= worst(areas.slice(first, first + count), side)) count++;
    const row = areas.slice(first, first + count);
    const thick = row.reduce((sum, each) => sum + each, 0) / side;
    let along = 0;
    for (const each of row) {
      const long = each / thick;
      boxes.push(width >= height ? [x, y + along, thick, long] : [x + along, y, long, thick]);
      along += long;
    }
    if (width >= height) [x, width] = [x + thick, width - thick];
    else [y, height] = [y + thick, height - thick];
    first += count;
  }
  return boxes;
}

function worst(row, side) {
  const sum = row.reduce((all, each) => all + each, 0);
  return Math.max((side ** 2 * Math.max(...row)) / sum ** 2, sum ** 2 / (side ** 2 * Math.min(...row)));
}
