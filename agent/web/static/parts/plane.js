// OP against PV: the loop that a sticking valve draws, measured and by the model. And the map of valves.
import { number } from "./format.js";
import { html, useEffect, useRef } from "./html.js";
import { colour } from "./chart.js";

const SIZE = 300;
const PAD = { left: 46, right: 10, top: 8, bottom: 34 };

export function Plane({ op, pv, model }) {
  const finite = (values) => values.filter((value) => value !== null);
  const [x0, x1] = range(finite(op));
  const [y0, y1] = range([...finite(pv), ...finite(model ?? [])]);
  const sx = (value) => PAD.left + ((SIZE - PAD.left - PAD.right) * (value - x0)) / (x1 - x0 || 1);
  const sy = (value) => SIZE - PAD.bottom - ((SIZE - PAD.top - PAD.bottom) * (value - y0)) / (y1 - y0 || 1);
  const line = (values) => {
    let text = "";
    let pen = "M";
    values.forEach((value, k) => {
      if (value === null || op[k] === null) {
        pen = "M";
        return;
      }
      text += `${pen}${sx(op[k]).toFixed(1)} ${sy(value).toFixed(1)}`;
      pen = "L";
    });
    return text;
  };
  return html`<svg class="square" viewBox=${`0 0 ${SIZE} ${SIZE}`} role="img"
      aria-label=${`PV against OP: OP from ${number(x0)} to ${number(x1)}, PV from ${number(y0)} to ${number(y1)}; a loop with flat sides means a valve that stands still while OP moves`}>
    <line class="axis" x1=${PAD.left} x2=${SIZE - PAD.right} y1=${SIZE - PAD.bottom} y2=${SIZE - PAD.bottom} />
    <line class="axis" x1=${PAD.left} x2=${PAD.left} y1=${PAD.top} y2=${SIZE - PAD.bottom} />
    <text x=${PAD.left} y=${SIZE - PAD.bottom + 14}>${number(x0)}</text><text x=${SIZE - PAD.right} y=${SIZE - PAD.bottom + 14} text-anchor="end">${number(x1)}</text>
    <text x=${(SIZE + PAD.left) / 2} y=${SIZE - 6} text-anchor="middle">OP</text>
    <text x=${PAD.left - 5} y=${SIZE - PAD.bottom} text-anchor="end">${number(y0)}</text><text x=${PAD.left - 5} y=${PAD.top + 8} text-anchor="end">${number(y1)}</text>
    <text x="12" y=${SIZE / 2} text-anchor="middle">PV</text>
    <path class="measured" d=${line(pv)} />${model && html`<path class="model" d=${line(model)} />`}
  </svg>`;
}

function range(values) {
  if (values.length === 0) return [0, 1];
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low === high ? [low - 0.5, high + 0.5] : [low, high];
}

/** Error of every valve over f_D (across) and f_S (up); dark is as good as the best. */
export function ValveMap({ map }) {
  const canvas = useRef(null);
  useEffect(() => {
    const draw = () => {
      const rows = map.error.length;
      const columns = Math.ceil(rows / 2) + 1;
      canvas.current.width = columns;
      canvas.current.height = rows;
      const pen = canvas.current.getContext("2d");
      const [from, to] = [colour("heat0"), colour("heat1")].map((text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16)));
      for (let r = 0; r < rows; r++) {
        for (let c = 0; c < columns; c++) {
          const error = map.error[r][c];
          if (error === null || error === undefined) continue;
          const dark = Math.max(0, 1 - Math.log(Math.max(error, 1)) / Math.log(25));
          const best = error <= map.alike;
          pen.fillStyle = best ? colour("model") : `rgb(${from.map((low, k) => Math.round(low + dark * 0.8 * (to[k] - low))).join(" ")})`;
          pen.fillRect(c, rows - 1 - r, 1, 1);
        }
      }
    };
    draw();
    addEventListener("slipjump:theme", draw);
    return () => removeEventListener("slipjump:theme", draw);
  }, [map]);
  const top = map.f_s.at(-1);
  return html`<div class="map-frame"><span class="map-y"><span>${number(top)}</span><span>f_S</span><span>0</span></span>
      <canvas ref=${canvas} class="map-canvas" role="img"
        aria-label=${`Error of every valve: least at f_S ${number(map.best.f_s)}, f_D ${number(map.best.f_d)} OP units`}></canvas>
      <span class="map-x"><span>0</span><span>f_D, OP units</span><span>${number(top / 2)}</span></span></div>
    <p class="under">Least error at f_S = ${number(map.best.f_s)}, f_D = ${number(map.best.f_d)}. Dark is as good as the best; in colour: within ${Math.round(100 * (map.alike - 1))} % of it.</p>`;
}
