// What was found of a loop over months: S with its interval, repairs, and who did what.
import { Chart, colour } from "./chart.js";
import { moment, sentence, words } from "./format.js";
import { html, useMemo } from "./html.js";
import { alarmWords } from "./marks.js";
import { valuesText } from "./trend.js";

const SHOWN = 30;
const BAND = { bands: [{ series: [3, 2], fill: () => `${colour("bar")}38` }] };

export function History({ entries }) {
  const judged = useMemo(() => entries.filter((each) => each.kind === "diagnosis"), [entries]);
  const repairs = useMemo(() => entries.filter((each) => each.action === "repaired").map((each) => ({ at: each.time, label: "repaired" })), [entries]);
  const data = useMemo(() => {
    const value = (each, end) => (each.verdict === "no_stiction" ? null : each.stiction?.s?.[end] ?? null);
    const rows = [...judged.map((each) => [each.time, value(each, "value"), value(each, "low"), value(each, "high")]), ...repairs.map((each) => [each.at, null, null, null])];
    rows.sort((a, b) => a[0] - b[0]);
    return [0, 1, 2, 3].map((k) => rows.map((row) => row[k]));
  }, [judged, repairs]);
  const decided = entries.filter((each) => each.kind !== "diagnosis").slice(-SHOWN).reverse();
  if (!entries.length) return html`<p class="quiet">No window was judged yet: the first verdict comes when a window is full.</p>`;
  return html`
    ${data[1].filter((each) => each !== null).length > 1 && html`<${Chart} data=${data} height=${160} x=${{ time: true }} y=${{ label: "S, OP units" }} options=${BAND} marks=${repairs} kind="whole"
      text=${`S over ${judged.length} windows: ${valuesText(data[1])}${repairs.length ? `; ${repairs.length} repairs` : ""}`}
      lines=${[{ label: "S", colour: "measured", width: 1.8, points: 5 }, { label: "90 % interval", colour: "bar", width: 0.75 }, { label: "upper end", colour: "bar", width: 0.75 }]} />`}
    <p class="quiet">${judged.length} ${judged.length === 1 ? "window" : "windows"} judged${judged.length ? `, from ${moment(judged[0].time)} to ${moment(judged.at(-1).time)}` : ""}.</p>
    ${decided.length > 0 && html`<div class="scroll" tabindex="0" role="group" aria-label="Table"><table class="cards"><caption class="unseen">Alarms and decisions</caption>
      <thead><tr><th scope="col">Time</th><th scope="col">What</th><th scope="col">Who</th><th scope="col">Comment</th></tr></thead>
      <tbody>${decided.map((each) => html`<tr><td class="nowrap">${moment(each.time)}</td><td>${each.action ? sentence(words(each.action)) : alarmWords(each.state)}</td><td data-label="Who">${each.by ?? "diagnosis"}</td><td class="said wide-cell">${each.comment ?? ""}</td></tr>`)}</tbody></table></div>`}`;
}
