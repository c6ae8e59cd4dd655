// PV with the model, OP, and the residual, on one time axis; a brushed stretch lights up in each.
import { Chart, colour } from "./chart.js";
import { html, useEffect, useMemo, useRef } from "./html.js";
import { number } from "./format.js";

const SYNC = "workbench";

export function Curves({ model, quick, stretch, brush }) {
  const { curves, step } = model;
  const spans = useMemo(() => model.left_out.map(([from, to]) => ({ from, to, colour: "muted", label: "left out" })), [model]);
  const time = useMemo(() => curves.pv.map((_, k) => k * step), [curves]);
  const shown = quick ?? curves.model;
  const residual = useMemo(() => (quick ? curves.pv.map((value, k) => (value === null || quick[k] === null ? null : value - quick[k])) : curves.residual), [curves, quick]);
  const top = useMemo(() => [time, curves.pv, shown], [time, curves, shown]);
  const middle = useMemo(() => [time, curves.op], [time, curves]);
  const low = useMemo(() => [time, residual], [time, residual]);
  const light = useLight(stretch, brush);
  return html`<${Chart} data=${top} sync=${SYNC} height=${240} y=${{ label: "PV" }} options=${light} spans=${spans} text=${`PV and PV of the model, fit ${number(model.fit_percent)} %`}
      lines=${[{ label: "PV", colour: "measured" }, { label: quick ? "PV of the model, before its fit" : "PV of the model", colour: "model", width: 1.6 }]} />
    <${Chart} data=${middle} sync=${SYNC} height=${130} y=${{ label: "OP" }} options=${light} spans=${spans} text="OP" lines=${[{ label: "OP", colour: "measured" }]} />
    <${Chart} data=${low} sync=${SYNC} height=${160} x=${{ label: "time, s" }} y=${{ label: "residual, PV units" }} options=${light} spans=${spans} text=${`Residual, held-out error ${number(model.rmse)}`}
      lines=${[{ label: "PV less the model", colour: "model" }]} />`;
}

/** Options of uPlot for charts that share a brushed stretch. */
function useLight(stretch, brush) {
  const known = useRef({ stretch: null, plots: new Set(), brush });
  known.current.brush = brush;
  useEffect(() => {
    known.current.stretch = stretch;
    for (const plot of known.current.plots) plot.redraw(false, true);
  }, [stretch]);
  return useMemo(() => ({
    cursor: { sync: { key: SYNC }, points: { size: 5 }, drag: { x: true, y: false, setScale: false } },
    hooks: {
      init: [(plot) => known.current.plots.add(plot)],
      destroy: [(plot) => known.current.plots.delete(plot)],
      setSelect: [(plot) => {
        if (plot.select.width < 3) return;
        known.current.brush([plot.posToVal(plot.select.left, "x"), plot.posToVal(plot.select.left + plot.select.width, "x")]);
        plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
      }],
      drawClear: [(plot) => {
        const lit = known.current.stretch;
        if (!lit) return;
        const [left, right] = lit.map((each) => plot.valToPos(each, "x", true));
        plot.ctx.save();
        plot.ctx.globalAlpha = 0.18;
        plot.ctx.fillStyle = colour("accent");
        plot.ctx.fillRect(left, plot.bbox.top, right - left, plot.bbox.height);
        plot.ctx.restore();
      }],
    },
  }), []);
}
