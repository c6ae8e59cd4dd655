// How wide a place is, so that what is drawn there keeps its letters readable.
import { useLayoutEffect, useRef, useState } from "./html.js";

/** A ref for an element and its width, px; 0 before it is there. */
export function useWidth() {
  const place = useRef(null);
  const [width, set] = useState(0);
  useLayoutEffect(() => {
    const measure = () => set(place.current?.clientWidth ?? 0);
    measure();
    const observer = new ResizeObserver(measure);
    observer.observe(place.current);
    return () => observer.disconnect();
  }, []);
  return [place, width];
}
