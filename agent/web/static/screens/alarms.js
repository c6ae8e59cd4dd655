// The list of alarms after ISA-18.2: not acknowledged first, then active, shelved with time left, out of service.
import { get } from "../parts/api.js";
import { duration, moment, number, words } from "../parts/format.js";
import { html, useEffect, useState } from "../parts/html.js";
import { AlarmMark, Shape, alarmWords } from "../parts/marks.js";
import { useStream } from "../parts/stream.js";

const SECTIONS = ["unacked_active", "returned_unacked", "acked_active", "shelved", "out_of_service"];

export default function Alarms() {
  const parts = useStream("/api/alarms/stream");
  const [decisions, set] = useState([]);
  const alarms = parts?.alarms;
  useEffect(() => { document.title = "Alarms"; }, []);
  useEffect(() => {
    const stop = new AbortController();
    get("/api/alarms/decisions", stop.signal).then(set, () => {});
    return () => stop.abort();
  }, [JSON.stringify(alarms?.map((each) => [each.loop, each.alarm, each.until]))]);
  const open = alarms?.filter((each) => each.alarm === "unacked_active" || each.alarm === "returned_unacked").length;
  return html`<div class="headline"><h1>Alarms</h1>
      <p class="lead">${alarms ? (alarms.length ? `${alarms.length} not normal, ${open} not acknowledged.` : "All alarms are normal.") : "Loading"}</p></div>
    ${SECTIONS.map((state) => [state, (alarms ?? []).filter((each) => each.alarm === state)]).filter(([, rows]) => rows.length).map(([state, rows]) => html`
      <section class="card" key=${state} style=${{ marginBottom: "1rem" }}><h2>${alarmWords(state)} <span class="count">${rows.length}</span></h2>
        <div class="scroll" tabindex="0" role="group" aria-label="Table"><table><caption class="unseen">${alarmWords(state)}</caption>
          <thead><tr><th scope="col">Loop</th><th scope="col">Verdict</th><th scope="col">Priority</th><th scope="col">NE 107</th><th scope="col" class="number">S, OP units</th><th scope="col">Since</th><th scope="col">${state === "shelved" ? "Time left" : "By"}</th></tr></thead>
          <tbody>${rows.map((row) => html`<tr data-loop=${row.loop} data-alarm=${row.alarm}><th scope="row"><a href=${`/loops/${encodeURIComponent(row.loop)}`}>${row.loop}</a></th>
            <td><span class=${`verdict-words ${row.group}`}><${Shape} group=${row.group} size=${14} /> ${row.words}</span></td><td>${row.priority}</td><td>${words(row.ne107)}</td>
            <td class="number">${number(row.s?.value)}</td><td class="nowrap">${moment(row.since)}</td>
            <td>${state === "shelved" ? `${duration(row.until - Date.now() / 1000)}, by ${row.by}` : row.by ?? ""}</td></tr>`)}</tbody></table></div></section>`)}
    <section class="card"><h2>Who did what</h2>
      ${decisions.length === 0 ? html`<p class="quiet">Nothing was kept yet.</p>` : html`<div class="scroll" tabindex="0" role="group" aria-label="Table"><table><caption class="unseen">Changes of alarms and decisions, the newest first</caption>
        <thead><tr><th scope="col">Time</th><th scope="col">Loop</th><th scope="col">What</th><th scope="col">Who</th><th scope="col">Comment</th></tr></thead>
        <tbody>${decisions.map((each) => html`<tr><td class="nowrap">${moment(each.time)}</td><td><a href=${`/loops/${encodeURIComponent(each.loop)}`}>${each.loop}</a></td>
          <td>${each.kind === "note" ? words(each.action) : html`<${AlarmMark} row=${{ alarm: each.state, priority: "" }} />`}</td><td>${each.by ?? "diagnosis"}</td><td>${each.comment ?? ""}</td></tr>`)}</tbody></table></div>`}
    </section>`;
}
