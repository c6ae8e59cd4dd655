// Begin: a recording from this machine, a window of the plant, or a session that is open.
import { get, send, upload } from "./api.js";
import { html, useEffect, useState } from "./html.js";

export function Opening({ open }) {
  const [known, setKnown] = useState(null);
  const [busy, setBusy] = useState(false);
  const [fault, setFault] = useState(null);
  const [loops, setLoops] = useState([]);
  useEffect(() => {
    let timer = 0;
    let left = false;
    const look = () => get("/api/workbench/sessions").then((found) => {
      if (left) return;
      setKnown(found);
      if (found.live) get("/api/loops").then(setLoops, () => setLoops([]));
      else if (!found.sessions.length) timer = setTimeout(look, 2000); // one that the command line opens
    }, (error) => { if (!left) setFault(error.message); });
    look();
    return () => {
      left = true;
      clearTimeout(timer);
    };
  }, []);
  const begin = async (work) => {
    setBusy(true);
    setFault(null);
    try {
      open((await work()).session);
    } catch (error) {
      setFault(error.message);
    }
    setBusy(false);
  };
  const chosen = (event) => {
    const file = event.target.files[0];
    if (file && known && file.size > known.largest) setFault(`${file.name} has ${Math.round(file.size / 1048576)} MB, at most ${Math.round(known.largest / 1048576)} MB are taken: cut out a stretch`);
    else if (file) begin(() => upload(`/api/workbench/sessions?name=${encodeURIComponent(file.name)}`, file));
  };
  return html`<div class="headline"><h1>Workbench</h1>
    <p class="lead">Compare a model with a recording, see where it fails, tick the missing effect and watch the error fall.</p></div>
    ${fault && html`<p class="problem" role="alert" data-testid="fault">${fault}</p>`}
    <div class="grid">
      <section class="card"><h2>Open a recording</h2>
        <label class="field">CSV, Excel or Parquet with time, OP and PV<input type="file" data-testid="upload" disabled=${busy} onChange=${chosen} /></label>
        ${busy && html`<p class="loading" role="status">Reading and fitting the first model</p>`}</section>
      ${known?.live && html`<section class="card"><h2>Or the newest window of a loop</h2>
        <ul class="entries">${loops.slice(0, 200).map((each) => html`<li><button type="button" disabled=${busy} onClick=${() => begin(() => send(`/api/workbench/loops/${encodeURIComponent(each)}`))}>${each}</button></li>`)}</ul></section>`}
      ${known?.sessions.length > 0 && html`<section class="card"><h2>Go on with a session</h2>
        <ul class="entries">${known.sessions.map((each) => html`<li><button type="button" onClick=${() => open(each.session)}>${each.recording ?? "being read"}</button></li>`)}</ul></section>`}
    </div>`;
}
