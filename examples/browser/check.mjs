// Opens the page in Chromium without a window, drags the hole, throws vertices about, and checks what the page shows:
// `node examples/browser/check.mjs [FOLDER [VERTICES [RUNS]]]`, after `examples/browser/build`. Writes pictures of the page to
// FOLDER. Needs no package of npm. CHROMIUM names the browser, which uses SwiftShader if there is no graphics card.
import { spawn } from "node:child_process";
import { createServer } from "node:http";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [folder = ".", vertices = 2000, runs = 1] = process.argv.slice(2);
const here = import.meta.dirname;
const types = { html: "text/html", js: "text/javascript", wasm: "application/wasm" };
const server = createServer((request, response) => {
  const name = new URL(request.url, "http://localhost").pathname.slice(1) || "index.html";
  try {
    const content = readFileSync(join(here, name));
    response.writeHead(200, { "content-type": types[name.split(".").pop()] ?? "text/plain" }).end(content);
  } catch {
    response.writeHead(404).end();
  }
});
await new Promise(ready => server.listen(0, "127.0.0.1", ready));

// Controls Chromium through a pipe, by JSON messages that end with a zero byte.
const profile = mkdtempSync(join(tmpdir(), "chromium-"));
const flags = ["--headless", "--no-sandbox", "--enable-unsafe-webgpu", "--remote-debugging-pipe",
  "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync", `--user-data-dir=${profile}`, "--window-size=1420,900", "about:blank"];
const stdio = ["ignore", "ignore", "ignore", "pipe", "pipe"];
const browser = spawn(process.env.CHROMIUM ?? "chromium", flags, { stdio });
const answers = new Map();
let unread = "", number = 0, session;
browser.stdio[4].on("data", data => {
  const messages = (unread + data).split("\0");
  unread = messages.pop();
  for (const message of messages.map(text => JSON.parse(text))) {
    if (message.id) answers.get(message.id)(message);
    else if (message.method === "Runtime.consoleAPICalled") {
      console.log("console:", ...message.params.args.map(arg => arg.value ?? arg.description));
    }
  }
});
async function send(method, params = {}) {
  const id = ++number;
  const { result, error } = await new Promise(answer => {
    answers.set(id, answer);
    browser.stdio[3].write(JSON.stringify({ id, method, params, sessionId: session }) + "\0");
  });
  if (error) throw new Error(`${method}: ${error.message}`);
  return result;
}
async function evaluate(expression, awaitPromise = false) {
  const { result, exceptionDetails } =
    await send("Runtime.evaluate", { expression, awaitPromise, returnByValue: true });
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
  return result.value;
}
const pause = milliseconds => new Promise(done => setTimeout(done, milliseconds));
async function until(what, condition, seconds = 60) {
  for (let tries = 0; tries < 20 * seconds; tries++) {
    const error = await evaluate("window.seen?.error ?? null");
    if (error) throw new Error(error);
    if (await evaluate(condition)) return;
    await pause(50);
  }
  throw new Error(`not within ${seconds} seconds: ${what}`);
}
async function picture(name) {
  const { data } = await send("Page.captureScreenshot");
  writeFileSync(join(folder, name), Buffer.from(data, "base64"));
}
function check(what, holds) {
  console.log(holds ? "ok:" : "WRONG:", what);
  if (!holds) process.exitCode = 1;
}
// Waits until f does not change for ten frames.
async function still() {
  let last, now;
  do {
    last = now;
    const start = await evaluate("seen.frames[0]");
    await until("ten frames", `seen.frames[0] - seen.frames[1] >= ${start} + 10`);
    now = await evaluate("seen.numbers[0]");
  } while (!(Math.abs(now / last - 1) < 1e-6));
}
const median = values => values.toSorted((a, b) => a - b)[values.length >> 1]?.toFixed(2);
async function frames(name) {
  const [times, calls] = await evaluate("[seen.times.splice(0), seen.calls.splice(0)]");
  console.log(`${name}: ${times.length} frames, median ${median(times)} ms, of which the call takes ${median(calls)} ms`);
}

try {
  mkdirSync(folder, { recursive: true });
  const url = `http://127.0.0.1:${server.address().port}/?vertices=${vertices}&runs=${runs}`;
  const { targetId } = await send("Target.createTarget", { url });
  session = (await send("Target.attachToTarget", { targetId, flatten: true })).sessionId;
  await send("Runtime.enable");
  await until("frames after the runs", "window.seen?.frames[0] >= 40 && seen.frames[1] < 4", 600);
  console.log(await evaluate("document.getElementById('about').textContent"));
  const { runs: done } = await evaluate("seen");
  for (const [name, times] of Object.entries(done)) {
    const { before, after, sweeps, inverted } = times[0];
    console.log(`${name}: f ${before} to ${after}, ${sweeps} sweeps, ${times.map(run => run.time.toFixed(0)).join(", ")} ms`);
    check(`${name}: better, and nothing inverted`, after < before && inverted === 0);
  }
  const [cpu, gpu] = Object.values(done).map(times => times[0].after);
  check("the engines agree", Math.abs(cpu / gpu - 1) < 1e-5);
  const faults = await evaluate("page.faults()", true);
  faults.forEach(text => console.log("fault:", text));
  check("the errors of the browser reach the caller", faults.length === 3 && faults[0].includes("buffer")
    && faults[1] === "no error" && faults[2].includes("lost"));
  await frames("settling");
  await still();
  check("frames come to the same f", Math.abs(await evaluate("seen.numbers[0]") / cpu - 1) < 1e-4);
  await picture("settled.png");

  const [x, y] = await evaluate(`(() => {
    const { left, top, width, height } = document.getElementById("live").getBoundingClientRect();
    return [left + width / 2, top + height / 2];
  })()`);
  const mouse = (type, x, y) =>
    send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons: 1, clickCount: 1 });
  await evaluate("seen.times.splice(0), seen.calls.splice(0)");
  await mouse("mousePressed", x, y);
  for (let step = 1; step <= 20; step++) {
    await mouse("mouseMoved", x + 4 * step, y - 2 * step);
    await pause(30);
  }
  await still();
  await frames("dragging");
  await picture("dragged.png");
  const [f, worst, inverted] = await evaluate("seen.numbers");
  console.log(`dragged: f ${f}, worst inverse mean ratio ${worst}, ${inverted} inverted`);
  check("a drag moves the hole and inverts nothing", f > 1.001 * cpu && inverted === 0 && worst < 8);
  await mouse("mouseReleased", x + 80, y - 40);
  await still();
  await picture("rested.png");
  const rested = await evaluate("seen.numbers[0]");

  await evaluate("seen.times.splice(0), seen.calls.splice(0), document.getElementById('tear').click()");
  const start = await evaluate("seen.frames[0]");
  await until("a frame that is torn, and one that is mended", "seen.most > 0 && seen.numbers[2] === 0");
  const [most, end] = await evaluate("[seen.most, seen.frames[0]]");
  console.log(`torn: ${most} triangles and corners inverted at most in frames that were seen, none after ${end - start} frames`);
  await still();
  await frames("mending");
  await picture("mended.png");
  const mended = await evaluate("seen.numbers[0]");
  console.log(`f ${rested} at rest, ${mended} when mended`);
  check("what was torn comes back", Math.abs(mended / rested - 1) < 1e-3);
} catch (error) {
  check(error.message, false);
  if (session) await picture("failed.png").catch(() => {});
} finally {
  server.close();
  server.closeAllConnections();
  session = undefined;
  const gone = new Promise(done => browser.on("exit", done));
  await Promise.race([send("Browser.close").then(() => gone), pause(5000)]);
  browser.kill();
  rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
}
