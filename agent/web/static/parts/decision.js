// What a person decides about an alarm: acknowledge, shelve for a time, take out of service and back.
import { send } from "./api.js";
import { html, useState } from "./html.js";
import { keepWho, who } from "./who.js";

export function Decision({ row, id, decided }) {
  const [by, setBy] = useState(who());
  const [comment, setComment] = useState("");
  const [hours, setHours] = useState("8");
  const [said, say] = useState(null);
  const [busy, setBusy] = useState(false);
  const order = async (action, more = {}) => {
    if (!by.trim()) {
      say({ fault: true, text: "Enter your name first: decisions are signed." });
      document.getElementById("decision-by").focus();
      return;
    }
    setBusy(true);
    try {
      keepWho(by.trim());
      await send(`/api/loops/${encodeURIComponent(row.loop)}/orders`, { action, by: by.trim(), comment, alarm: id ?? null, ...more });
      say({ fault: false, text: "Done. The buses get the new state." });
      setComment("");
      decided?.();
    } catch (error) {
      say({ fault: true, text: error.message });
    } finally {
      setBusy(false);
    }
  };
  const judge = async (judgement) => {
    if (!by.trim() || !comment.trim()) {
      say({ fault: true, text: "Enter your name and, as the comment, why: a judgement is signed and has a reason." });
      return;
    }
    setBusy(true);
    try {
      keepWho(by.trim());
      await send(`/api/loops/${encodeURIComponent(row.loop)}/judgement`, { judgement, by: by.trim(), comment });
      say({ fault: false, text: "Kept. The work list shows it; the alarm stays as it is." });
      setComment("");
      decided?.();
    } catch (error) {
      say({ fault: true, text: error.message });
    } finally {
      setBusy(false);
    }
  };
  const unacknowledged = row.alarm === "unacked_active" || row.alarm === "returned_unacked";
  const silenced = row.alarm === "shelved" || row.alarm === "out_of_service";
  return html`<div class="decision">
    <label class="field">Your name<input id="decision-by" value=${by} maxlength="80" autocomplete="name" onInput=${(event) => setBy(event.target.value)} /></label>
    <label class="field">Comment<textarea rows="2" maxlength="1000" value=${comment} onInput=${(event) => setComment(event.target.value)}></textarea></label>
    <div class="buttons">
      <button type="button" class=${unacknowledged ? "primary" : ""} data-testid="acknowledge" disabled=${busy || !unacknowledged} onClick=${() => order("acknowledge")}>Acknowledge</button>
      ${row.alarm === "out_of_service"
        ? html`<button type="button" disabled=${busy} onClick=${() => order("in_service")}>Return to service</button>`
        : html`<button type="button" disabled=${busy} onClick=${() => order("out_of_service")}>Out of service</button>`}
      ${row.alarm === "shelved" && html`<button type="button" disabled=${busy} onClick=${() => order("unshelve")}>Unshelve</button>`}
    </div>
    ${row.alarm !== "out_of_service" && html`<div class="buttons"><label class="field">Hours<input type="number" min="0.1" max="8760" step="any" value=${hours} onInput=${(event) => setHours(event.target.value)} size="5" /></label>
      <button type="button" disabled=${busy || !(Number(hours) > 0)} onClick=${() => order("shelve", { hours: Number(hours) })} class="low">${silenced ? "Shelve anew" : "Shelve"}</button></div>`}
    <div class="buttons"><span class="quiet">Your own judgement, with a comment:</span>
      <button type="button" disabled=${busy} data-testid="judge-sticks" onClick=${() => judge("sticks")}>It sticks</button>
      <button type="button" disabled=${busy} data-testid="judge-sound" onClick=${() => judge("sound")}>It is sound</button>
      ${row.judgement && html`<button type="button" disabled=${busy} onClick=${() => judge("withdrawn")}>Withdraw</button>`}</div>
    <p role="status" class=${said?.fault ? "problem" : "done"} hidden=${!said}>${said?.text}</p>
  </div>`;
}
