// Trends of a loop: what is held and what comes, with the model over it; and the window that was judged.
import { get } from "./api.js";
import { Chart } from "./chart.js";
import { duration, number } from "./format.js";
import { html, useEffect, useMemo, useRef, useState } from "./html.js";

const LONGEST = 7200; // samples drawn
const SET_POINT = { label: "SP", colour: "setpoint", dash: [5, 4] };

/** Samples that are held, the new ones as they come, and the model where its window is still among them. */
export function Trend({ base, newest, roles, model }) {
  const [held, set] = useState(null);
  const loading = useRef(false);
  useEffect(() => {
    if (newest === undefined || newest === null || loading.current) return;
    loading.current = true;
    const last = held && held.time.length ? held.time.at(-1) : null;
    get(`${base}/window${last === null ? "" : `?since=${last}`}`).then((found) => set((now) => joined(last === null ? null : now, found)), () => {}).finally(() => { loading.current = false; });
  }, [newest, base]);
  const time = held?.time;
  const over = useMemo(() => (held && model ? { pv: onto(time, model, model.model_pv), valve: onto(time, model, model.valve) } : {}), [held, model]);
  const top = useMemo(() => held && [time, held.columns.pv, ...(roles.includes("sp") ? [held.columns.sp] : []), ...(over.pv ? [over.pv] : [])], [held, over]);
  const low = useMemo(() => held && [time, held.columns.op, ...(roles.includes("mv") ? [held.columns.mv] : []), ...(over.valve ? [over.valve] : [])], [held, over]);
  if (!held || time.length === 0) return html`<p class="quiet" role="status">No sample yet.</p>`;
  const span = duration(time.at(-1) - time[0]);
  return html`
    <${Chart} data=${top} height=${190} sync=${base} x=${{ time: true }} y=${{ label: "PV" }} text=${`PV over the last ${span}: ${valuesText(held.columns.pv)}`}
      lines=${[{ label: "PV", colour: "measured" }, ...(roles.includes("sp") ? [SET_POINT] : []), ...(over.pv ? [{ label: "PV of the model", colour: "model", width: 1.6 }] : [])]} />
    <${Chart} data=${low} height=${160} sync=${base} x=${{ time: true }} y=${{ label: "OP" }} text=${`OP over the last ${span}: ${valuesText(held.columns.op)}`}
      lines=${[{ label: "OP", colour: "measured" }, ...(roles.includes("mv") ? [{ label: "MV, measured", colour: "setpoint" }] : []), ...(over.valve ? [{ label: "Valve of the model", colour: "valve", width: 1.6 }] : [])]} />
    ${model && !over.pv && html`<p class="quiet">The window that was judged is older than what is shown here; its model is below.</p>`}`;
}

/** Values of the model at the times of the trend; null where the two do not overlap. */
function onto(time, model, values) {
  if (!values) return null;
  const found = time.map((at) => values[Math.round((at - model.start) / model.ts)] ?? null);
  return found.some((value) => value !== null) ? found : null;
}

function joined(now, { start, ts, columns }) {
  const n = columns.pv?.length ?? 0;
  const time = Array.from({ length: n }, (_, k) => start + k * ts);
  if (!now) return { time, columns };
  if (n === 0) return now;
  const all = { time: [...now.time, ...time].slice(-LONGEST), columns: {} };
  for (const role of Object.keys(columns)) all.columns[role] = [...(now.columns[role] ?? []), ...columns[role]].slice(-LONGEST);
  return all;
}

export function valuesText(values) {
  const finite = values.filter((value) => value !== null && value !== undefined);
  if (!finite.length) return "no values";
  return `from ${number(finite.reduce((a, b) => Math.min(a, b)))} to ${number(finite.reduce((a, b) => Math.max(a, b)))}, newest ${number(finite.at(-1))}`;
}

/** The window that was judged, with PV and valve of its model. */
export function JudgedWindow({ model, diagnosis }) {
  const time = useMemo(() => model.pv.map((_, k) => model.start + k * model.ts), [model]);
  const top = useMemo(() => [time, model.pv, ...(model.sp ? [model.sp] : []), ...(model.model_pv ? [model.model_pv] : [])], [model]);
  const low = useMemo(() => [time, model.op, ...(model.valve ? [model.valve] : [])], [model]);
  const fit = diagnosis?.fit?.free_run_percent;
  return html`
    <${Chart} data=${top} height=${190} sync="model" x=${{ time: true }} y=${{ label: "PV" }} text=${`PV and PV of the model; the model explains ${number(fit)} percent`}
      lines=${[{ label: "PV", colour: "measured" }, ...(model.sp ? [SET_POINT] : []), ...(model.model_pv ? [{ label: `PV of the model${fit ? `, fit ${number(fit)} %` : ""}`, colour: "model", width: 1.6 }] : [])]} />
    <${Chart} data=${low} height=${160} sync="model" x=${{ time: true }} y=${{ label: "OP" }} text="OP and the valve position of the model"
      lines=${[{ label: "OP", colour: "measured" }, ...(model.valve ? [{ label: "Valve of the model", colour: "valve", width: 1.6 }] : [])]} />`;
}
