// uPlot in the theme's colours, as wide as its place, with its content in words for who cannot see it.
import uPlot from "../vendor/uPlot.esm.js";
import { html, useEffect, useLayoutEffect, useRef } from "./html.js";

export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

const axis = (label, size) => ({
  label,
  labelSize: label ? 18 : 0,
  size,
  font: "11px system-ui, sans-serif",
  labelFont: "11px system-ui, sans-serif",
  stroke: () => colour("muted"),
  grid: { stroke: () => colour("grid"), width: 1 },
  ticks: { stroke: () => colour("grid"), width: 1, size: 4 },
});

const NONE = [];

/** Stretches and moments, behind the lines. */
function drawBehind(plot, { spans, marks }) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  for (const each of spans) {
    const [left, right] = [each.from, each.to].map((value) => plot.valToPos(value, "x", true));
    ctx.globalAlpha = 0.16;
    ctx.fillStyle = colour(each.colour);
    ctx.fillRect(left, bbox.top, right - left, bbox.height);
    if (each.label) sign(ctx, each.label, left + 4, bbox.top);
  }
  for (const each of marks) {
    const at = Math.round(plot.valToPos(each.at, "x", true));
    ctx.globalAlpha = 1;
    ctx.fillStyle = colour("ink");
    ctx.fillRect(at, bbox.top, devicePixelRatio, bbox.height);
    sign(ctx, each.label, at + 4, bbox.top);
  }
  ctx.restore();
}

function sign(ctx, text, left, top) {
  ctx.globalAlpha = 1;
  ctx.fillStyle = colour("muted");
  ctx.textBaseline = "top";
  ctx.fillText(text, left, top + 3);
}

const two = (value) => String(value).padStart(2, "0");

/** Times of an axis, 24 hours; with the day where the axis spans more than one. */
function clock(_, splits) {
  const long = splits.length > 1 && splits.at(-1) - splits[0] > 86400;
  const fine = splits.length > 1 && splits[1] - splits[0] < 60;
  return splits.map((each) => {
    const date = new Date(1000 * each);
    const day = `${two(date.getMonth() + 1)}-${two(date.getDate())}`;
    if (long && splits[1] - splits[0] >= 86400) return day;
    const time = `${two(date.getHours())}:${two(date.getMinutes())}${fine ? `:${two(date.getSeconds())}` : ""}`;
    return long ? `${day} ${time}` : time;
  });
}

/**
 * A chart. ``lines``: [{label, colour (a name of the theme), width, dash, points}]; ``data``: [x, ...one array a line],
 * null is a gap; ``x``: {label, time}; ``y``: {label, range}; ``text``: what the chart shows, in words.
 * ``spans``: [{from, to, colour, label}] behind the lines; ``marks``: [{at, label}], moments with a name. ``kind``: "whole" where
 * the last line belongs to the one before and has no name of its own.
 */
export function Chart({ data, lines, x = {}, y = {}, height = 220, text, sync, options = {}, spans = NONE, marks = NONE, kind = "" }) {
  const place = useRef(null);
  const plot = useRef(null);
  const behind = useRef({ spans, marks });
  behind.current = { spans, marks };
  const shape = JSON.stringify([lines, x, y, height, sync, Object.keys(options)]);
  useLayoutEffect(() => {
    const made = new uPlot(
      {
        width: place.current.clientWidth || 300,
        height,
        legend: { live: false },
        cursor: { sync: sync ? { key: sync } : undefined, points: { size: 5 }, drag: { setScale: true } },
        scales: { x: { time: Boolean(x.time), range: x.range }, y: { range: y.range } },
        axes: [{ ...axis(x.label, 28), ...(x.time ? { values: clock } : {}) }, axis(y.label, 48)],
        series: [
          { label: x.label ?? "time" },
          ...lines.map((line) => ({
            label: line.label,
            stroke: () => colour(line.colour),
            width: line.width ?? 1.25,
            dash: line.dash,
            points: { show: Boolean(line.points), size: line.points ?? 0 },
            paths: line.paths?.(uPlot),
            spanGaps: false,
          })),
        ],
        ...options,
        hooks: { ...options.hooks, drawClear: [(drawn) => drawBehind(drawn, behind.current), ...(options.hooks?.drawClear ?? [])] },
      },
      data,
      place.current,
    );
    plot.current = made;
    const observer = new ResizeObserver(() => made.setSize({ width: place.current.clientWidth || 300, height }));
    observer.observe(place.current);
    const redraw = () => made.redraw(false, true);
    const system = matchMedia("(prefers-color-scheme: dark)");
    addEventListener("slipjump:theme", redraw);
    system.addEventListener("change", redraw);
    return () => {
      observer.disconnect();
      removeEventListener("slipjump:theme", redraw);
      system.removeEventListener("change", redraw);
      made.destroy();
      plot.current = null;
    };
  }, [shape]);
  useEffect(() => {
    if (plot.current && plot.current.data !== data) plot.current.setData(data);
  }, [data]);
  useEffect(() => plot.current?.redraw(false, true), [spans, marks]);
  return html`<figure class=${`chart ${kind}`} role="img" aria-label=${text}><div ref=${place}></div></figure>`;
}
