// Translates the user's input into options, requests images and draws them.
"use strict";

const $ = (id) => document.getElementById(id);
const canvas = $("picture");
let frame = null;

// ---- Requests -------------------------------------------------------------------------------------------------------

/** f-numbers in steps of a third of a stop, rounded as on the aperture rings of lenses. */
const fNumbers = [1, 1.1, 1.2, 1.4, 1.6, 1.8, 2, 2.2, 2.5, 2.8, 3.2, 3.5, 4, 4.5, 5, 5.6, 6.3, 7.1, 8, 9, 10, 11, 13, 14, 16, 18, 20, 22,
  25, 29, 32, 36, 40, 45];
const fNumberOf = (step) => fNumbers[Math.min(fNumbers.length - 1, Math.max(0, step))];
const stepOf = (fNumber) => fNumbers.reduce((best, n, i) => Math.abs(Math.log(n / fNumber)) < Math.abs(Math.log(fNumbers[best] / fNumber)) ? i : best, 0);

/** The focus slider is linear in the inverse distance. It ranges from 0.9 times the nearest depth to infinity. */
const sliderSteps = 1000;
const nearest = () => 0.9 * (frame.nearest_m ?? 0.3);
const focusOf = (t) => t >= sliderSteps ? Infinity : Number((nearest() / (1 - t / sliderSteps)).toPrecision(4));
const sliderOf = (m) => m === Infinity ? sliderSteps : Math.round(sliderSteps * Math.max(0, 1 - nearest() / m));

const lens = { fNumber: 2.8, focus: 1, focalLength: 50, impulse: "disc", shutter: "" };
let undoStack = [];

/** Options of the command for the current lens. */
function lensOptions(of = lens) {
  const options = { "f-number": String(of.fNumber), focus: of.focus === Infinity ? "inf" : String(of.focus) };
  if (of.focalLength !== frame.focal_length_mm) options["focal-length"] = String(of.focalLength);
  if (of.impulse !== "disc") options.impulse = of.impulse;
  if (of.shutter) options.shutter = of.shutter;
  return options;
}

/** Options of the successive requests for an image, from coarse to fine. The last request makes the final image. */
function stages() {
  if (!frame.records_kept) return [{}];
  const views = (n) => ({ method: "lightfield", views: String(n) });
  const first = lens.shutter ? views(4) : { method: "scatter" };
  return [first, views(16), views(64), frame.scene ? { method: "auto", "target-db": "40" } : views(256)];
}

let shown = null;    // the displayed image: {width, height, by (width of its pixels, px of the frame), halves, report, options}
let settled = null;  // the last displayed image that was not a quick first one
let other = null;    // the image that the displayed image is compared with
let depths = null;   // {ids, inverse}
let causes = null;   // causes of the error of `causes.picture`: {picture, rgba, report}
let generation = 0;  // serial number of the latest request
let firstUnderWay = false, refining = false;
// When the lens changes, a coarse image is requested first, and it is always finished, even if the lens
// changes again meanwhile. Then `again` is the time, in ms, of the first of these changes, and images for the
// newest lens are requested as soon as the coarse image is finished. Otherwise, it is 0.
let again = 0;
const timings = [];  // for benchmarks: {views, input, answered, painted}
window.postlens = { timings, state: () => ({ shown, other, depths, causes, lens, frame, generation, working: firstUnderWay || refining }) };

/** Returns the JSON text at the beginning of a reply, and the position of the binary data that follows it. */
function parseReport(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  return { report: JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length))), begin: Math.ceil((4 + length) / 4) * 4 };
}

function parsePicture(buffer) {
  const { report, begin } = parseReport(buffer);
  const halves = new Uint16Array(buffer, begin, report.width * report.height * 3);
  const end = begin + 2 * halves.length;
  const rayShare = report.has_ray_share ? new Uint16Array(buffer, end, report.width * report.height) : null;
  return { width: report.width, height: report.height, by: report.by ?? 1, halves, rayShare, report };
}

async function ask(what, options) {
  const answer = await fetch(`${what}?${new URLSearchParams(options)}`).catch(() => {
    throw new Error("no answer: postlens view has ended, or cannot be reached");
  });
  if (answer.status === 409) return null;  // cancelled by a newer request
  if (!answer.ok) throw new Error((await answer.json().catch(() => ({ error: `${answer.status}` }))).error);
  return answer;
}

/** Repeats a request up to eight times, because another request may cancel it. The time between two attempts is random,
    so that two pages do not cancel each other forever. */
async function askAgain(what, options, isWanted = () => true) {
  for (let attempt = 0; attempt < 8; ++attempt) {
    if (attempt > 0) await new Promise((resume) => setTimeout(resume, 100 * 2 ** attempt * Math.random()));
    if (!await isWanted()) return null;
    const answer = await ask(what, options);
    if (answer) return answer;
  }
  return null;
}

let beside = Promise.resolve();  // ends when the last request by `askBeside` ends

/** Requests an additional image. The server makes one image at a time, so finer versions of the displayed image wait. */
function askBeside(what, options) {
  const answer = askAgain(what, options);
  beside = answer.catch(() => null);
  return answer;
}

const pictureIn = async (answer) => answer && parsePicture(await answer.arrayBuffer());

/** Requests images for the current lens. The first, coarse image is always finished, so that an image is visible
    while a slider is dragged. The next input cancels the finer images. */
async function refocus(input = performance.now()) {
  if (firstUnderWay) {
    again ||= input;
    return;
  }
  const mine = ++generation;
  dropCauses();
  const options = lensOptions();
  const all = stages();
  for (const [i, stage] of all.entries()) {
    const asked = { ...options, ...stage }, isFirst = i === 0, isQuick = isFirst && all.length > 1;
    firstUnderWay = isFirst;
    refining = !isFirst;
    say(isFirst ? "" : "finer…");
    let picture = null, failure = null;
    try {
      picture = await pictureIn(await askAgain(isQuick ? "coarse" : "picture", asked, async () => {
        if (!isQuick) await beside;
        return !again && mine === generation;
      }));
    } catch (error) {
      failure = error;
    }
    if (mine !== generation) return;  // a newer request has replaced this one during its refinement
    firstUnderWay = refining = false;
    if (picture) {
      // A coarse preview is shown until the final image is ready. If the user copies the command or saves the
      // image meanwhile, the final image is meant. So the preview is stored with the options of the last
      // stage, `all.at(-1)`.
      shown = { ...picture, options: isQuick ? { ...options, ...all.at(-1) } : asked };
      if (!isQuick) settled = shown;
      const answered = performance.now();
      drawSoon(() => timings.push({ views: stage.views ?? stage.method ?? "", input, answered, painted: performance.now(),
                                    server: picture.report.seconds }));
    }
    if (again) {
      const since = again;
      again = 0;
      refocus(since);
      return;
    }
    if (failure) say(failure.message, true);
    if (!picture && !isQuick) return;
  }
  describe();
  if (pointed) tellPixel(pointed);  // the displayed values are those of the previous lens
  findCauses();
}

/** Displays method, views, stated error and warnings of the current image. */
function describe() {
  if (!shown) return;
  const r = shown.report, parts = [`${r.method ?? ""}${r.views ? `, ${r.views} views` : ""}`];
  if (r.stated_db) parts.push(`${r.stated_db.toFixed(1)} dB measured (${r.stated_low_db.toFixed(1)} to ${r.stated_high_db?.toFixed(1) ?? "∞"})`);
  for (const warning of r.warnings) parts.push(warning.text);
  say(parts.join(" · "));
}

/** Changes the lens, and records the change so that it can be undone. */
function change(what) {
  undoStack.push({ ...lens });
  if (undoStack.length > 200) undoStack.shift();
  Object.assign(lens, what);
  keepBefore();
  showControls();
  refocus();
}

function undo() {
  if (undoStack.length === 0) return;
  Object.assign(lens, undoStack.pop());
  keepBefore();
  showControls();
  refocus();
}

// ---- Comparing ------------------------------------------------------------------------------------------------------

let comparison = 0;  // serial number of the latest image to compare with

function keepBefore() {
  if ($("compare").value === "before" && settled) other = settled;
  if ($("compare").value === "rays") traceRays().catch((error) => say(error.message, true));
}

async function compareWith(what) {
  const mine = ++comparison;
  $("wipe").hidden = what === "nothing";
  if (what === "nothing") other = null;
  if (what === "before") other = settled ?? shown;
  try {
    if (what === "pinhole") {
      const picture = await pictureIn(await askBeside("picture", { method: "pinhole" }));
      if (mine !== comparison) return;
      other = picture;
    }
    if (what === "rays") await traceRays();
  } catch (error) {
    say(error.message, true);
  }
  drawSoon();
}

/** Requests ray-traced images with independent seeds, up to 1024 samples per pixel, and displays their running mean. */
async function traceRays() {
  const mine = ++comparison;
  const options = lensOptions();
  let sum = null, samples = 0;
  for (let seed = 1; samples < 1024; ++seed) {
    const spp = Math.max(4, Math.min(64, samples));
    const picture = await pictureIn(await ask("rays", { ...options, spp: String(spp), seed: String(seed) }));
    if (!picture || mine !== comparison) return;
    sum ??= new Float32Array(picture.halves.length);
    for (let i = 0; i < sum.length; ++i) sum[i] += spp * floatOf(picture.halves[i]);
    samples += spp;
    other = { ...picture, floats: sum.map((v) => v / samples), samples };
    drawSoon();
  }
}

// ---- Causes of the error --------------------------------------------------------------------------------------------

let causesOf = null;             // the image whose causes are being found
let dropping = null;             // the request that cancels this search
let causesFailure = "";

/** Requests the causes of the error of the displayed image, if they are to be shown. */
async function findCauses() {
  if ($("show").value !== "causes" || !shown || shown !== settled || firstUnderWay || refining || causes?.picture === shown || causesOf === shown) return;
  const picture = causesOf = shown;
  causesFailure = "";
  showLegend();
  try {
    await dropping;
    const answer = causesOf === picture && await ask("causes", picture.options);
    if (causesOf !== picture) return;
    if (!answer) throw new Error("cancelled: another page of this viewer asked as well");
    const buffer = await answer.arrayBuffer(), { report, begin } = parseReport(buffer);
    if (causesOf !== picture) return;
    const bytes = new Uint8Array(buffer, begin, report.width * report.height), rgba = new Uint8Array(4 * bytes.length);
    // The overlay's alpha of 191 (of 255) leaves a quarter of the image visible.
    for (let k = 0; k < bytes.length; ++k) if (bytes[k] > 0) rgba.set([...report.causes[bytes[k]].colour, 191], 4 * k);
    causes = { picture, rgba, report };
  } catch (error) {
    if (causesOf !== picture) return;
    causesFailure = error.message;
  }
  causesOf = null;
  showLegend();
  drawSoon();
}

/** Discards the causes of the error, and cancels the search for them. */
function dropCauses() {
  if (causesOf) dropping = fetch("drop_causes").catch(() => null);
  causes = causesOf = null;
  causesFailure = "";
  showLegend();
}

function showLegend() {
  $("legend").hidden = $("show").value !== "causes";
  if ($("legend").hidden) return;
  const line = (text, colour) => {
    const row = document.createElement("p");
    if (colour) row.appendChild(document.createElement("i")).style.background = `rgb(${colour.join(" ")})`;
    row.append(text);
    return row;
  };
  if (!causes) {
    const text = causesFailure || (causesOf ? "finding the causes of the error: rays, then a test of each cause…" : "the causes follow when the picture is ready");
    return $("legend").replaceChildren(line(text));
  }
  const found = causes.report.causes.filter((cause) => cause.error_share > 0).sort((a, b) => b.error_share - a.error_share);
  const rows = found.map((cause) => line(`${cause.name}: ${(100 * cause.error_share).toFixed(1)} % of the squared error`, cause.colour));
  if (found.length === 0) rows.push(line("no pixel is wrong"));
  $("legend").replaceChildren(...rows, line(`against ${causes.report.spp} rays a pixel`));
}

// ---- Numbers --------------------------------------------------------------------------------------------------------

const halfTable = new Float32Array(65536);
for (let bits = 0; bits < 65536; ++bits) {
  const sign = bits & 0x8000 ? -1 : 1, exponent = (bits >> 10) & 31, fraction = bits & 1023;
  halfTable[bits] = sign * (exponent === 0 ? fraction * 2 ** -24
    : exponent === 31 ? (fraction ? NaN : Infinity) : (1 + fraction / 1024) * 2 ** (exponent - 15));
}
const floatOf = (bits) => halfTable[bits];
/** R, G and B of an image at pixel k of the frame. */
function valuesOf(p, k) {
  if (p.by > 1) {
    const x = Math.floor((k % frame.width) / p.by), y = Math.floor(k / (frame.width * p.by));
    k = Math.min(y, p.height - 1) * p.width + Math.min(x, p.width - 1);
  }
  return p.floats ? [p.floats[3 * k], p.floats[3 * k + 1], p.floats[3 * k + 2]]
    : [floatOf(p.halves[3 * k]), floatOf(p.halves[3 * k + 1]), floatOf(p.halves[3 * k + 2])];
}

/** CoC diameter per difference of inverse depths, px m: the diameter of the aperture times the film distance in px. */
function cocPerInverse() {
  // Without a stated film distance, the focal length is used (docs/inputs.md).
  const filmDistance = frame.film_distance_from_focal_length ? lens.focalLength : frame.film_distance_mm;
  return lens.focalLength / lens.fNumber * filmDistance / 1000 / frame.pixel_pitch_mm;
}
const inverseFocus = () => lens.focus === Infinity ? 0 : 1 / lens.focus;
const modes = ["picture", "in_focus", "coc", "depth", "id", "brightness", "unsure", "noise", "causes"];
const needsDepths = (mode) => ["in_focus", "coc", "depth", "id"].includes(mode);

/** Per-pixel values, 0 to 1, for the modes "unsure" and "noise". "unsure" is the square root of the fraction of the
    pixel that was computed by rays. "noise" is the noise of the light field, from 60 dB (0) to 30 dB (1). Both exist
    only for images that the method auto has made with the scene. */
function shares(mode) {
  const { width, height } = frame, { rayShare, report } = shown, out = new Float32Array(width * height);
  if (mode === "unsure" && rayShare) for (let k = 0; k < out.length; ++k) out[k] = Math.sqrt(floatOf(rayShare[k]));
  if (mode === "noise" && report.tiles) {
    const { edge_px: edge, columns, noise_mse: noise } = report.tiles;
    const levels = noise.map((mse) => Math.min(1, Math.max(0, (60 + 10 * Math.log10(Math.max(mse, 1e-9))) / 30)));
    for (let y = 0, k = 0; y < height; ++y)
      for (let x = 0; x < width; ++x, ++k) out[k] = levels[Math.floor(y / edge) * columns + Math.floor(x / edge)];
  }
  return out;
}
let sharesOf = {};  // {picture, mode, values}: image and mode for which `values` were computed
function sharesNow(mode) {
  if (sharesOf.picture !== shown || sharesOf.mode !== mode) sharesOf = { picture: shown, mode, values: shares(mode) };
  return sharesOf;
}
const needsShares = (mode) => ["unsure", "noise"].includes(mode);
const sharpPx = 1.5;  // a pixel is drawn as in focus if its circle of confusion has at most this diameter, px

// ---- Drawing --------------------------------------------------------------------------------------------------------

/** The image in the window: its scale, device px per image px, and the position of its upper left corner, device px. */
const view = { scale: 0, x: 0, y: 0, fits: true };

function fitView() {
  const w = canvas.width, h = canvas.height, pw = frame.width, ph = frame.height;
  view.scale = Math.min(w / pw, h / ph);
  view.x = (w - pw * view.scale) / 2;
  view.y = (h - ph * view.scale) / 2;
  view.fits = true;
}

const vertexShader = `#version 300 es
const vec2 corners[3] = vec2[](vec2(-1, -1), vec2(3, -1), vec2(-1, 3));
void main() { gl_Position = vec4(corners[gl_VertexID], 0, 1); }`;
const fragmentShader = `#version 300 es
precision highp float; precision highp int; precision highp usampler2D;
uniform sampler2D now, before, inverse, shares, causes; uniform usampler2D ids;
uniform vec2 window, origin, size; uniform float now_by, before_by, scale, gain, wipe, coc_scale, focus, nearest; uniform int mode; uniform bool has_before;
out vec4 colour;
vec3 heat(float t) { t = clamp(t, 0.0, 1.0);
  return clamp(vec3(1.5 - abs(4.0 * t - 3.0), 1.5 - abs(4.0 * t - 2.0), 1.5 - abs(4.0 * t - 1.0)), 0.0, 1.0); }
vec3 srgb(vec3 c) { c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(max(c, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)); }
vec3 seen(sampler2D picture, float by, ivec2 p) {
  return (by == 1.0 ? texelFetch(picture, p, 0) : texture(picture, (vec2(p) + 0.5) / (by * vec2(textureSize(picture, 0))))).rgb; }
void main() {
  vec2 at = (vec2(gl_FragCoord.x, window.y - gl_FragCoord.y) - origin) / scale;
  ivec2 p = ivec2(floor(at));
  if (p.x < 0 || p.y < 0 || p.x >= int(size.x) || p.y >= int(size.y)) { colour = vec4(vec3(0.25), 1); return; }
  bool old = has_before && gl_FragCoord.x < wipe * window.x;
  vec3 c = (old ? seen(before, before_by, p) : seen(now, now_by, p)) * gain;
  float z = texelFetch(inverse, p, 0).r, coc = coc_scale * abs(z - focus);
  if (mode == 1) { float grey = dot(srgb(c), vec3(0.2126, 0.7152, 0.0722)); c = coc <= ${sharpPx.toFixed(1)} ? mix(srgb(c), vec3(0.1, 1, 0.3), 0.45) : vec3(grey * 0.6); }
  else if (mode == 2) c = heat(log2(1.0 + coc) / 6.0);
  else if (mode == 3) c = heat(z / nearest);
  else if (mode == 4) { uint id = texelFetch(ids, p, 0).r; uint h = (id + 1u) * 2654435761u;
    c = id == 0u ? vec3(0) : vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0; }
  else if (mode == 5) { float l = dot(c, vec3(0.2126, 0.7152, 0.0722)); c = l <= 0.0 ? vec3(0) : heat((log2(l) + 8.0) / 12.0); }
  else if (mode == 8) { vec4 cause = texelFetch(causes, p, 0); c = mix(vec3(0.5 * dot(srgb(c), vec3(0.3333))), cause.rgb, cause.a); }
  else if (mode >= 6) { float t = texelFetch(shares, p, 0).r; c = mix(vec3(0.5 * dot(srgb(c), vec3(0.3333))), heat(t), t > 0.0 ? 0.75 : 0.0); }
  else c = srgb(c);
  colour = vec4(c, 1);
}`;

class GlPainter {
  constructor(gl) {
    this.gl = gl;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    this.at = (name) => gl.getUniformLocation(program, name);
    this.textures = ["now", "before", "inverse", "ids", "shares", "causes"].map((name, unit) => {
      const texture = gl.createTexture();
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
      for (const wrap of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, wrap, gl.CLAMP_TO_EDGE);
      gl.uniform1i(this.at(name), unit);
      return { name, held: undefined };
    });
    this.hold(1, null, () => gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB16F, 1, 1, 0, gl.RGB, gl.HALF_FLOAT, new Uint16Array(3)));
    this.hold(2, null, () => gl.texImage2D(gl.TEXTURE_2D, 0, gl.R16F, 1, 1, 0, gl.RED, gl.HALF_FLOAT, new Uint16Array(1)));
    this.hold(4, null, () => gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, 1, 1, 0, gl.RED, gl.FLOAT, new Float32Array(1)));
    this.hold(3, null, () => gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32UI, 1, 1, 0, gl.RED_INTEGER, gl.UNSIGNED_INT, new Uint32Array(1)));
  }
  hold(unit, what, upload) {
    if (this.textures[unit].held === what) return;
    this.textures[unit].held = what;
    this.gl.activeTexture(this.gl.TEXTURE0 + unit);
    upload();
  }
  picture(unit, p) {
    const gl = this.gl;
    this.hold(unit, p, () => {
      if (p.floats) gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB32F, p.width, p.height, 0, gl.RGB, gl.FLOAT, p.floats);
      else gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB16F, p.width, p.height, 0, gl.RGB, gl.HALF_FLOAT, p.halves);
      for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
        gl.texParameteri(gl.TEXTURE_2D, filter, p.by > 1 ? gl.LINEAR : gl.NEAREST);
    });
    gl.uniform1f(this.at(unit === 0 ? "now_by" : "before_by"), p.by);
  }
  paint(s) {
    const gl = this.gl;
    this.picture(0, shown);
    if (other) this.picture(1, other);
    if (depths) {
      const { width, height } = frame;
      this.hold(2, depths, () => gl.texImage2D(gl.TEXTURE_2D, 0, gl.R16F, width, height, 0, gl.RED, gl.HALF_FLOAT, depths.inverse));
      this.hold(3, depths, () => gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32UI, width, height, 0, gl.RED_INTEGER, gl.UNSIGNED_INT, depths.ids));
    }
    const rgba = causes?.rgba ?? null;
    this.hold(5, rgba, () => gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, rgba ? frame.width : 1, rgba ? frame.height : 1, 0, gl.RGBA,
                                           gl.UNSIGNED_BYTE, rgba ?? new Uint8Array(4)));
    if (needsShares(modes[s.mode])) {
      const now = sharesNow(modes[s.mode]);
      this.hold(4, now, () => gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, frame.width, frame.height, 0, gl.RED, gl.FLOAT, now.values));
    }
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.uniform2f(this.at("window"), canvas.width, canvas.height);
    gl.uniform2f(this.at("origin"), view.x, view.y);
    gl.uniform2f(this.at("size"), frame.width, frame.height);
    for (const name of ["scale", "gain", "wipe", "coc_scale", "focus", "nearest"]) gl.uniform1f(this.at(name), s[name]);
    gl.uniform1i(this.at("mode"), s.mode);
    gl.uniform1i(this.at("has_before"), other ? 1 : 0);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }
}

/** Draws the same as the WebGL painter, but pixel by pixel on the CPU, for browsers without WebGL2. Wider pixels are not
    interpolated. */
class PlainPainter {
  constructor(context) { this.context = context; }
  paint(s) {
    const { width: w, height: h } = canvas, image = this.context.createImageData(w, h), out = image.data;
    const heat = (t) => [3, 2, 1].map((c) => Math.min(1, Math.max(0, 1.5 - Math.abs(4 * Math.min(1, Math.max(0, t)) - c))));
    const srgb = (v) => { v = Math.min(1, Math.max(0, v)); return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055; };
    for (let y = 0, o = 0; y < h; ++y) {
      for (let x = 0; x < w; ++x, o += 4) {
        const px = Math.floor((x + 0.5 - view.x) / view.scale), py = Math.floor((y + 0.5 - view.y) / view.scale);
        let c = [0.25, 0.25, 0.25];
        if (px >= 0 && py >= 0 && px < frame.width && py < frame.height) {
          const k = py * frame.width + px;
          const rgb = valuesOf(other && x + 0.5 < s.wipe * w ? other : shown, k).map((v) => v * s.gain);
          const light = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
          const z = depths ? floatOf(depths.inverse[k]) : 0, coc = s.coc_scale * Math.abs(z - s.focus);
          if (s.mode === 1) {
            const [r, g, b] = rgb.map(srgb);
            c = coc <= sharpPx ? [r, g, b].map((v, i) => 0.55 * v + 0.45 * [0.1, 1, 0.3][i]) : [0, 0, 0].fill(0.6 * (0.2126 * r + 0.7152 * g + 0.0722 * b));
          }
          else if (s.mode === 2) c = heat(Math.log2(1 + coc) / 6);
          else if (s.mode === 3) c = heat(z / s.nearest);
          else if (s.mode === 4) {
            const id = depths?.ids[k] ?? 0, hash = Math.imul(id + 1, 2654435761);
            c = [0, 8, 16].map((by) => id === 0 ? 0 : ((hash >>> by) & 255) / 255);
          }
          else if (s.mode === 5) c = light <= 0 ? [0, 0, 0] : heat((Math.log2(light) + 8) / 12);
          else if (s.mode === 8) {
            const grey = 0.5 * (srgb(rgb[0]) + srgb(rgb[1]) + srgb(rgb[2])) / 3, a = causes ? causes.rgba[4 * k + 3] / 255 : 0;
            c = [0, 1, 2].map((i) => (1 - a) * grey + (a > 0 ? a * causes.rgba[4 * k + i] / 255 : 0));
          }
          else if (s.mode >= 6) {
            const t = sharesNow(modes[s.mode]).values[k], grey = 0.5 * (srgb(rgb[0]) + srgb(rgb[1]) + srgb(rgb[2])) / 3;
            c = heat(t).map((v) => t > 0 ? 0.25 * grey + 0.75 * v : grey);
          }
          else c = rgb.map(srgb);
        }
        for (let i = 0; i < 3; ++i) out[o + i] = 255 * c[i] + 0.5;
        out[o + 3] = 255;
      }
    }
    this.context.putImageData(image, 0, 0);
  }
}

let painter = null, wipe = 0.5, drawing = false, afterwards = [];

function drawSoon(then) {
  if (then) afterwards.push(then);
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    if (!shown) return;
    painter.paint({ scale: view.scale, gain: 2 ** Number($("exposure").value), wipe, coc_scale: cocPerInverse(), focus: inverseFocus(),
                    nearest: 1 / nearest(), mode: modes.indexOf($("show").value) });
    $("wipe").style.left = `${100 * wipe}%`;
    const done = afterwards;
    afterwards = [];
    for (const call of done) call();
  });
}

function resize() {
  const ratio = window.devicePixelRatio || 1, fits = view.fits;
  const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  if (fits) fitView();
  drawSoon();
}

function zoom(factor, x = canvas.width / 2, y = canvas.height / 2) {
  const scale = Math.min(64, Math.max(0.05, view.scale * factor));
  view.x = x - (x - view.x) * scale / view.scale;
  view.y = y - (y - view.y) * scale / view.scale;
  view.scale = scale;
  view.fits = false;
  drawSoon();
}

function pan(x, y) {
  view.x += x;
  view.y += y;
  view.fits = false;
  drawSoon();
}

// ---- Under the pointer ----------------------------------------------------------------------------------------------

function pixelAt(event) {
  const box = canvas.getBoundingClientRect(), ratio = canvas.width / box.width;
  const x = ((event.clientX - box.left) * ratio - view.x) / view.scale, y = ((event.clientY - box.top) * ratio - view.y) / view.scale;
  return x >= 0 && y >= 0 && x < frame.width && y < frame.height ? [x, y] : null;
}

const pixelOptions = ([x, y]) => ({ x: x.toFixed(2), y: y.toFixed(2), ...Object.fromEntries(Object.entries(lensOptions()).filter(([k]) => ["f-number", "focus", "focal-length"].includes(k))) });
const metres = (m) => m === null ? "∞" : `${Number(m.toPrecision(3))} m`;
let hover = 0;       // serial number of the latest request for a pixel
let pointed = null;  // the position in the frame under the pointer

async function tellPixel(at) {
  const mine = ++hover;
  const k = Math.floor(at[1]) * frame.width + Math.floor(at[0]);
  const lines = [`${Math.floor(at[0])}, ${Math.floor(at[1])}   ${valuesOf(shown, k).map((v) => v.toPrecision(3)).join("  ")}`];
  if (depths) lines[0] += `   CoC ${(cocPerInverse() * Math.abs(floatOf(depths.inverse[k]) - inverseFocus())).toFixed(1)} px`;
  $("under").textContent = lines[0];
  await new Promise((resolve) => setTimeout(resolve, 250));
  if (mine !== hover || firstUnderWay) return;
  try {
    const answer = await ask("pixel", pixelOptions(at));
    if (!answer || mine !== hover) return;
    for (const node of (await answer.json()).nodes.slice(0, 6)) {
      const coc = node.coc_px ? `CoC ${Math.max(...node.coc_px).toFixed(1)} px` : "";
      const what = [node.path, node.name || node.id || ""].filter(Boolean).join("  ");
      lines.push(`${(100 * node.share).toFixed(0)} %  ${what}  z' ${metres(node.z_m)}  ${coc}`);
    }
    $("under").textContent = lines.join("\n");
  } catch (error) {
    say(error.message, true);
  }
}

async function focusAt(at) {
  try {
    const answer = await ask("pixel", pixelOptions(at));
    if (!answer) return;
    const node = (await answer.json()).clicked;
    if (!node) return say("nothing is stored there", true);
    change({ focus: node.focus_m === null ? Infinity : Number(node.focus_m.toPrecision(4)) });
    const where = !node.path || node.path === "primary" ? "" : ` in ${node.path.replaceAll("R", "mirror ").replaceAll("T", "glass ").trim()}`;
    const name = node.name || (node.focus_m === null ? "background" : "this depth");
    const text = `focus on ${name}${where}: ${metres(node.focus_m)}${node.behind_infinity ? " (its image lies behind infinity)" : ""}`;
    say(text);
  } catch (error) {
    say(error.message, true);
  }
}

// ---- Saving ---------------------------------------------------------------------------------------------------------

/** Returns the command line that makes the displayed image. */
function commandLine() {
  const quote = (text) => /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
  const options = shown.options, words = ["postlens", options.shutter ? "shoot" : "focus", quote(frame.file), "-o", "picture.exr"];
  for (const [name, value] of Object.entries(options)) words.push(`--${name}`, quote(value));
  if (frame.scene && options.method === "auto") words.push("--scene", quote(frame.scene));
  return words.join(" ");
}

async function copyCommand() {
  const text = commandLine();
  window.postlens.copied = text;
  try {
    await navigator.clipboard.writeText(text);
    say(`copied: ${text}`);
  } catch {
    say(text);  // the user can copy the text by hand
  }
}

async function save(format) {
  try {
    say("saving…");
    const options = shown.options;
    const answer = await askBeside("save", { ...options, format });
    if (!answer) return say("not saved: newer pictures were asked for again and again", true);
    const link = document.createElement("a");
    link.href = URL.createObjectURL(await answer.blob());
    link.download = `${frame.name.replace(/\.exr$/, "")}_f${options["f-number"]}_${options.focus}m.${format}`;
    link.click();
    URL.revokeObjectURL(link.href);
    say(`saved ${link.download}`);
  } catch (error) {
    say(error.message, true);
  }
}

// ---- Controls -------------------------------------------------------------------------------------------------------

function say(text, isError = false) {
  $("status").textContent = text;
  $("status").classList.toggle("error", isError);
}

function showControls() {
  $("f_number").value = stepOf(lens.fNumber);
  $("f_number_value").textContent = `f/${lens.fNumber}`;
  $("focus").value = sliderOf(lens.focus);
  $("focus_value").textContent = lens.focus === Infinity ? "∞" : String(lens.focus);
  for (const [id, text] of [["f_number", `f/${lens.fNumber}`], ["focus", `${lens.focus} m`]]) $(id).setAttribute("aria-valuetext", text);
  $("focal_length").value = lens.focalLength;
  $("blades").value = lens.impulse;
  $("shutter").value = lens.shutter;
  $("undo").disabled = undoStack.length === 0;
}

async function showMode() {
  if ($("status").classList.contains("error")) describe();  // removes the error message of the previous mode
  if ($("show").value === "causes") findCauses(); else if (causesOf) dropCauses();
  showLegend();
  if (needsDepths($("show").value) && !depths) {
    say("reading depths…");
    try {
      const answer = await askAgain("depths", {}, () => !depths);
      if (!answer) return;
      const buffer = await answer.arrayBuffer(), pixels = frame.width * frame.height;
      depths = { ids: new Uint32Array(buffer, 0, pixels), inverse: new Uint16Array(buffer, 4 * pixels, pixels) };
      describe();
    } catch (error) {
      say(error.message, true);
    }
  }
  if (needsShares($("show").value) && !shown?.report.tiles && !refining)
    say("known of pictures by auto, with the scene: postlens view FRAME SCENE", true);
  drawSoon();
}

const stepFNumber = (by) => change({ fNumber: fNumberOf(stepOf(lens.fNumber) + by) });
const stepFocus = (by) => change({ focus: focusOf(Math.min(sliderSteps, Math.max(0, sliderOf(lens.focus) + by))) });

function onKey(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || $("shortcuts").open) return;
  if (/^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && (event.key.length > 1 || event.target.type === "text" || event.target.type === "number")) return;
  const next = (id) => {
    const s = $(id);
    do s.selectedIndex = (s.selectedIndex + 1) % s.options.length; while (s.options[s.selectedIndex].disabled);
    s.dispatchEvent(new Event("change"));
  };
  const onCanvas = event.target === canvas || event.target === document.body;
  const step = canvas.width / 12;
  const keys = {
    "[": () => stepFNumber(-1), "]": () => stepFNumber(1), ",": () => stepFocus(-10), ".": () => stepFocus(10),
    e: () => expose(0.5), E: () => expose(-0.5), "+": () => zoom(1.25), "=": () => zoom(1.25), "-": () => zoom(0.8),
    0: () => { fitView(); drawSoon(); }, v: () => next("show"), u: undo, c: copyCommand,
    b: () => { $("compare").value = $("compare").value === "before" ? "nothing" : "before"; compareWith($("compare").value); },
    "?": () => $("shortcuts").showModal(),
    ...(onCanvas ? { Enter: () => focusAt([(canvas.width / 2 - view.x) / view.scale, (canvas.height / 2 - view.y) / view.scale]),
      ArrowLeft: () => pan(step, 0), ArrowRight: () => pan(-step, 0), ArrowUp: () => pan(0, step), ArrowDown: () => pan(0, -step) } : {}),
  };
  if (!keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
}

function expose(by) {
  $("exposure").value = Number($("exposure").value) + by;
  $("exposure").dispatchEvent(new Event("input"));
}

/** Connects a slider to the lens. One drag is a single step of undo. */
function slider(id, apply) {
  let before = null;
  $(id).addEventListener("input", () => {
    before ??= { ...lens };
    Object.assign(lens, apply(Number($(id).value)));
    showControls();
    refocus();
  });
  $(id).addEventListener("change", () => {
    if (before) undoStack.push(before);
    before = null;
    keepBefore();
    showControls();
  });
}

function listen() {
  slider("f_number", (step) => ({ fNumber: fNumberOf(step) }));
  slider("focus", (t) => ({ focus: focusOf(t) }));
  $("focal_length").addEventListener("change", () => { const v = Number($("focal_length").value); if (v > 0) change({ focalLength: v }); else showControls(); });
  $("blades").addEventListener("change", () => change({ impulse: $("blades").value }));
  $("shutter").addEventListener("change", () => { if ($("shutter").reportValidity()) change({ shutter: $("shutter").value.trim() }); });
  $("exposure").addEventListener("input", () => { $("exposure_value").textContent = $("exposure").value; drawSoon(); });
  $("show").addEventListener("change", showMode);
  $("compare").addEventListener("change", () => compareWith($("compare").value));
  $("undo").addEventListener("click", undo);
  $("copy").addEventListener("click", copyCommand);
  $("save_png").addEventListener("click", () => save("png"));
  $("save_exr").addEventListener("click", () => save("exr"));
  $("help").addEventListener("click", () => $("shortcuts").showModal());
  $("controls").addEventListener("submit", (event) => event.preventDefault());
  document.addEventListener("keydown", onKey);
  new ResizeObserver(resize).observe(canvas);

  let down = null, moved = false;
  canvas.addEventListener("pointerdown", (event) => { down = event; moved = false; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    if (down) {
      moved = moved || Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > 4;
      const ratio = canvas.width / canvas.clientWidth;
      if (moved) pan(event.movementX * ratio, event.movementY * ratio);
      return;
    }
    pointed = shown && pixelAt(event);
    if (pointed) tellPixel(pointed); else { ++hover; $("under").textContent = ""; }
  });
  canvas.addEventListener("pointerup", (event) => {
    const at = pixelAt(event);
    if (down && !moved && at) focusAt(at);
    down = null;
  });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const ratio = canvas.width / canvas.clientWidth, box = canvas.getBoundingClientRect();
    if (event.ctrlKey) zoom(2 ** (-event.deltaY / 200), (event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio);
    else stepFNumber(event.deltaY > 0 ? 1 : -1);
  }, { passive: false });

  const moveWipe = (to) => {
    wipe = Math.min(1, Math.max(0, to));
    $("wipe").setAttribute("aria-valuenow", Math.round(100 * wipe));
    drawSoon();
  };
  $("wipe").addEventListener("pointerdown", (event) => $("wipe").setPointerCapture(event.pointerId));
  $("wipe").addEventListener("pointermove", (event) => {
    const box = canvas.getBoundingClientRect();
    if ($("wipe").hasPointerCapture(event.pointerId)) moveWipe((event.clientX - box.left) / box.width);
  });
  $("wipe").addEventListener("keydown", (event) => {
    const by = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    moveWipe(wipe + by);
  });
}

async function begin() {
  const gl = new URLSearchParams(location.search).has("plain") ? null : canvas.getContext("webgl2", { alpha: false, antialias: false });
  painter = gl ? new GlPainter(gl) : new PlainPainter(canvas.getContext("2d"));
  frame = await (await ask("frame", {})).json();
  document.title = `${frame.name} · postlens`;
  lens.focalLength = frame.focal_length_mm ?? 50;
  lens.fNumber = Number.isFinite(frame.f_number) ? frame.f_number : 2.8;
  lens.focus = frame.focus_m === "inf" ? Infinity : frame.focus_m ?? 2;
  if (!frame.scene) $("compare").querySelector("[value=rays]").disabled = true;
  if (!frame.scene || !frame.records_kept) $("show").querySelector("[value=causes]").disabled = true;
  $("shutter_label").hidden = !frame.records_kept;
  listen();
  showControls();
  resize();
  refocus();
}

begin().catch((error) => say(error.message, true));
