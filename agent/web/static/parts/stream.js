// What changes: one EventSource for each page. It mends itself, and says when it is lost.
import { useEffect, useState } from "./html.js";

const AGAIN = 1500; // ms

const listeners = new Set();
export const connection = { lost: false, since: 0 };

function setLost(lost) {
  if (lost === connection.lost) return;
  connection.lost = lost;
  connection.since = Date.now();
  for (const each of listeners) each(lost);
}

/** Whether the connection to the agent is lost. */
export function useLost() {
  const [lost, set] = useState(connection.lost);
  useEffect(() => {
    listeners.add(set);
    return () => listeners.delete(set);
  }, []);
  return lost;
}

/** Parts of the stream at ``url``, newest state; null before the first. An empty url opens none. */
export function useStream(url) {
  const [parts, set] = useState(null);
  useEffect(() => {
    if (!url) return undefined;
    let source = null;
    let timer = 0;
    let known = {};
    const open = () => {
      source = new EventSource(url);
      source.onopen = () => setLost(false);
      source.onmessage = (event) => {
        const { full, parts: changed } = JSON.parse(event.data);
        known = full ? {} : { ...known };
        for (const [name, value] of Object.entries(changed)) {
          if (value === null) delete known[name];
          else known[name] = value;
        }
        setLost(false);
        set(known);
      };
      source.onerror = () => {
        setLost(true);
        source.close();
        clearTimeout(timer);
        timer = setTimeout(open, AGAIN);
      };
    };
    set(null);
    open();
    return () => {
      clearTimeout(timer);
      source.close();
    };
  }, [url]);
  return parts;
}
