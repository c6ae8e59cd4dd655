// The plant as a treemap: each area as large as it has loops, each loop a tile in it. Colour: somebody should look.
import { get } from "./api.js";
import { number } from "./format.js";
import { html, useEffect, useState } from "./html.js";
import { GROUPS, Shape } from "./marks.js";
import { useWidth } from "./width.js";

const AGAIN = 5000; // ms
const TALL = 620; // px
const HEAD = 34; // px, of an area
const GAP = 3; // px
const NAMED = 64; // px, from which a tile has its name
const ROOMY = 56; // px of height, from which it has its verdict, too
const LOUD = new Set(["sticks", "suspected", "tight_tuning", "disturbance"]);

export function PlantMap({ choose, shown }) {
  const [areas, set] = useState(null);
  const [place, width] = useWidth();
  useEffect(() => {
    const stop = new AbortController();
    const load = () => get("/api/work-list/map", stop.signal).then(set, () => {});
    load();
    const timer = setInterval(load, AGAIN);
    return () => {
      stop.abort();
      clearInterval(timer);
    };
  }, []);
  const sorted = [...(areas ?? [])].sort((a, b) => b.loops.length - a.loops.length);
  const loops = sorted.reduce((sum, each) => sum + each.loops.length, 0);
  const wide = Math.min(TALL, 180 + 14 * loops);
  const height = width < 500 ? Math.max(wide, 120 * sorted.length, 46 * loops > 1600 ? 1600 : 46 * loops) : wide;
  const boxes = width && loops ? squarified(sorted.map((each) => each.loops.length), 0, 0, width, height) : [];
  return html`<div class="plant-map" ref=${place} style=${{ height: `${loops ? height : 120}px` }}>
      ${areas && loops === 0 && html`<p class="empty">No loop yet.</p>`}
      ${sorted.map((each, k) => boxes[k] && html`<${Area} key=${each.area} area=${each} box=${boxes[k]} choose=${choose} shown=${shown} />`)}
    </div>
    <ul class="key map-key">${Object.entries(GROUPS).map(([group, words]) => html`<li><${Shape} group=${group} size=${13} /> ${words}</li>`)}</ul>`;
}

function Area({ area, box, choose, shown }) {
  const [x, y, w, h] = box;
  const counts = {};
  for (const [, group] of area.loops) counts[group] = (counts[group] ?? 0) + 1;
  const text = Object.entries(GROUPS).filter(([group]) => counts[group]).map(([group, words]) => `${counts[group]} ${words.toLowerCase()}`).join(", ");
  const [inner, tall] = [w - 24, h - HEAD - 18];
  const columns = columnsOf(area.loops.length, inner, tall);
  const rows = Math.ceil(area.loops.length / columns);
  const [wide, high] = [inner / columns - GAP, tall / rows - GAP];
  const named = wide >= NAMED && high >= 20;
  const size = Math.max(4, Math.min(wide, high, 20) - (named ? 4 : 2));
  return html`<section class="area" style=${{ left: `${x}px`, top: `${y}px`, width: `${w - 6}px`, height: `${h - 6}px` }} aria-label=${`Area ${area.area}: ${text}`}>
    <button type="button" class="area-name" title="Show this area as a list" onClick=${() => choose(area.area)}>${area.area} <span class="count">${area.loops.length}</span></button>
    <div class="marks" style=${{ gridTemplateColumns: `repeat(${columns}, minmax(0, 1fr))`, gridAutoRows: `${Math.max(high, 4)}px`, gap: `${GAP}px` }}>
      ${area.loops.map(([name, group, stale, s]) => html`<a key=${name} tabindex=${named ? 0 : -1} href=${`/loops/${encodeURIComponent(name)}`}
        class=${`mark ${LOUD.has(group) ? "loud" : ""} ${stale ? "stale" : group} ${named ? "named" : ""} ${shown && !shown(name, group, stale) ? "dim" : ""}`}
        title=${`${name}: ${GROUPS[group]}${s === null || group === "healthy" ? "" : `, S ${number(s)} OP units`}${stale ? ", stale data" : ""}`}>
        <${Shape} group=${stale ? "stale" : group} size=${size} />
        <span class=${named ? "mark-name" : "unseen"}>${name}${named && high >= ROOMY && html`<small>${GROUPS[group]}${s !== null && ["sticks", "suspected"].includes(group) ? `, S ${number(s)}` : ""}</small>`}</span></a>`)}</div>
  </section>`;
}

/** How many columns of tiles make them fill an area, each about twice as wide as high where names fit. */
function columnsOf(count, width, height) {
  const wanted = Math.sqrt((count * width) / Math.max(height, 1) / 2.2);
  return Math.max(1, Math.min(count, Math.round(wanted) || 1, Math.floor(width / 7) || 1));
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
