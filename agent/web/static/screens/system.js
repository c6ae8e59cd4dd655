// The agent itself: connections with their rates and what peers refuse, and loops without data.
import { duration, number, sentence } from "../parts/format.js";
import { html, useEffect } from "../parts/html.js";
import { useStream } from "../parts/stream.js";

export default function System() {
  const parts = useStream("/api/system/stream");
  useEffect(() => { document.title = "System"; }, []);
  if (!parts) return html`<h1>System</h1><p class="loading" role="status">Loading</p>`;
  const { agent, silent } = parts;
  const connections = Object.entries(parts).filter(([name]) => name.startsWith("connection:")).map(([, each]) => each);
  const facts = [["State", sentence(agent.status)], ["Waiting for a worker", agent.worker_queue], ["Orders taken, refused", `${agent.orders.taken}, ${agent.orders.refused}`],
    ["Faults of the program", agent.faults], ["Store failures", agent.store_failures], ["History dropped", agent.history_dropped]];
  return html`<div class="headline"><h1>System</h1><p class="lead">${sentence(agent.summary).replace(/\b1 (loop|connection)s\b/g, "1 $1")}.</p></div>
    <dl class="facts card">${facts.map(([key, value]) => html`<div><dt>${key}</dt><dd>${value}</dd></div>`)}</dl>
    ${agent.hung.length > 0 && html`<p class="problem" role="alert">Hangs: ${agent.hung.join("; ")}</p>`}
    <section class="card" style=${{ margin: "1rem 0" }}><h2>Connections</h2><div class="scroll" tabindex="0" role="group" aria-label="Table"><table class="cards"><caption class="unseen">Connections</caption>
      <thead><tr><th scope="col">Connection</th><th scope="col">State</th><th scope="col" class="number">Loops</th><th scope="col" class="number">Samples/s</th><th scope="col" class="number">Data age</th>
        <th scope="col" class="number">Losses</th><th scope="col" class="number">Unreadable</th><th scope="col" class="number">Outbox</th><th scope="col">Refused by the peer</th></tr></thead>
      <tbody>${connections.map((each) => html`<tr data-connection=${each.connection}><th scope="row">${each.connection}<span class="under">${each.bus}</span></th>
        <td><span class=${`light ${each.up ? "up" : "down"}`} aria-hidden="true"></span>${each.up ? "up" : html`<span class="down-words">down</span><span class="under">${each.problem}</span>`}</td>
        <td class="number" data-label="Loops">${each.loops}</td><td class="number" data-label="Samples/s">${number(each.rate)}</td><td class="number" data-label="Data age">${each.age === null ? "never" : duration(each.age)}</td>
        <td class="number" data-label="Losses">${each.losses}</td><td class="number" data-label="Unreadable">${each.malformed}</td>
        <td class="number" data-label="Outbox">${each.waiting}${each.oldest ? html`<span class="under">oldest ${duration(each.oldest)}</span>` : ""}${each.dropped ? html`<span class="under">${each.dropped} discarded</span>` : ""}</td>
        <td class="wide-cell" data-label="Refused by the peer">${each.refusals.length ? each.refusals.map((text) => html`<div>${text}</div>`) : html`<span class="quiet">nothing</span>`}</td></tr>`)}</tbody></table></div></section>
    <div class="grid"><${Silent} title="Never got data" names=${silent.never} count=${silent.never_count} /><${Silent} title="Data are stale" names=${silent.stale} count=${silent.stale_count} /></div>`;
}

function Silent({ title, names, count }) {
  return html`<section class="card"><h2>${title} <span class="count">${count}</span></h2>
    ${count === 0 ? html`<p class="quiet">No loop.</p>` : html`<ul class="plainlist">${names.map((name) => html`<li><a href=${`/loops/${encodeURIComponent(name)}`}>${name}</a></li>`)}</ul>`}</section>`;
}
