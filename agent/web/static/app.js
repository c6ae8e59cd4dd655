// The shell: navigation, theme, the banner of a lost connection, and the screen that the address names.
import { openSession } from "./parts/api.js";
import { html, render, useEffect, useState } from "./parts/html.js";
import { followLinks, match, useAddress } from "./parts/router.js";
import { useLost } from "./parts/stream.js";
import { ThemeButton } from "./parts/theme_button.js";

function Shell({ session }) {
  const address = useAddress();
  const path = new URL(address, location.origin).pathname;
  const found = session.screens.map((each) => [each, match(each.path, path)]).find(([, params]) => params);
  const [screen, params] = found ?? [null, {}];
  return html`
    <a class="skip" href="#main">Skip to the content</a>
    <header class="bar">
      <a class="brand" href=${session.screens[0].path}><img src="/static/icon.svg" alt="" width="26" height="26" />slipjump</a>
      <nav aria-label="Screens">
        ${session.screens.filter((each) => each.title).map((each) => html`
          <a href=${each.path} aria-current=${each === screen ? "page" : undefined}>${each.title}</a>`)}
      </nav>
      <span class="plant">${session.title === "slipjump" ? "" : session.title}</span>
      <${ThemeButton} />
    </header>
    <${Lost} />
    <main id="main" tabindex="-1">
      ${screen ? html`<${Loaded} key=${screen.name} name=${screen.name} params=${params} address=${address} />` : html`<${Nothing} />`}
    </main>
    <footer class="foot"><span>slipjump ${session.version}</span><a href="/api/docs">REST interface</a></footer>`;
}

/** A screen, as soon as its module is here. */
function Loaded({ name, params, address }) {
  const [module, set] = useState(null);
  const [fault, setFault] = useState(null);
  useEffect(() => {
    import(`./screens/${name}.js`).then(set, (error) => setFault(error.message));
  }, [name]);
  if (fault) return html`<p class="problem" role="alert">This screen could not be loaded: ${fault}</p>`;
  if (!module) return html`<p class="loading" role="status">Loading</p>`;
  return html`<${module.default} params=${params} address=${address} />`;
}

function Lost() {
  const lost = useLost();
  return html`<div role="status" class="lost" hidden=${!lost}>
    <strong>Connection lost.</strong> The agent does not answer; what you see is old. Trying again.
  </div>`;
}

function Nothing() {
  return html`<h1>Nothing here</h1><p>No screen has this address. <a href="/">Go to the first screen</a></p>`;
}

async function start() {
  followLinks();
  for (;;) {
    try {
      const session = await openSession();
      document.title = session.title;
      render(html`<${Shell} session=${session} />`, document.getElementById("app"));
      return;
    } catch (error) {
      render(html`<p class="lost" role="alert">The agent does not answer (${error.message}). Trying again.</p>`, document.getElementById("app"));
      await new Promise((done) => setTimeout(done, 1500));
    }
  }
}

start();
