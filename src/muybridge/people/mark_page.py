"""The page on which marks are drawn: one file, nothing from elsewhere."""

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>muybridge mark</title>
<style>
body { font: 15px sans-serif; margin: 1em; background: #f4f4f2; color: #222 }
canvas { border: 1px solid #888; cursor: crosshair; max-width: 100% }
button { margin-right: .5em; padding: .3em .8em } #said { margin-left: 1em } p { max-width: 60em }
label { margin-right: 1em }
</style></head><body>
<p><b>What hides people:</b> click the corners, double-click the last. <b>The smallest person who matters:</b>
choose it, and drag a box from head to feet; or type the height.</p>
<p><label><input type="radio" name="mode" value="polygon" checked> what hides people</label>
<label><input type="radio" name="mode" value="person"> smallest person</label>
<label>height <input id="smallest" type="number" min="8" max="10000" step="1" style="width:6em"> pixels</label>
<button id="undo">Undo</button><button id="clear">Clear</button><button id="save">Save</button>
<button id="done">Save and finish</button><span id="said"></span></p>
<canvas id="picture"></canvas>
<script>
"use strict";
const canvas = document.getElementById("picture"), context = canvas.getContext("2d");
const smallest = document.getElementById("smallest"), said = document.getElementById("said");
const image = new Image();
let polygons = [], open = [], box = null, from = null;
const mode = () => document.querySelector("input[name=mode]:checked").value;
function at(event) {
  const place = canvas.getBoundingClientRect(), scale = canvas.width / place.width;
  return [Math.round((event.clientX - place.left) * scale), Math.round((event.clientY - place.top) * scale)];
}
function outline(points, closed) {
  context.beginPath();
  points.forEach(([x, y], k) => k ? context.lineTo(x, y) : context.moveTo(x, y));
  if (closed) { context.closePath(); context.fill(); }
  context.stroke();
}
function draw() {
  context.drawImage(image, 0, 0);
  context.lineWidth = Math.max(1, canvas.width / 400);
  context.strokeStyle = "#fff"; context.fillStyle = "rgba(220, 40, 40, .45)";
  polygons.forEach(points => outline(points, true));
  context.strokeStyle = "#ff0";
  if (open.length) { outline(open, false); context.strokeRect(open[0][0] - 2, open[0][1] - 2, 4, 4); }
  if (box) { context.strokeStyle = "#0df"; context.strokeRect(...box); }
}
canvas.addEventListener("mousedown", event => { if (mode() === "person") { from = at(event); } });
canvas.addEventListener("mousemove", event => {
  if (!from) return;
  const [x, y] = at(event);
  box = [Math.min(x, from[0]), Math.min(y, from[1]), Math.abs(x - from[0]), Math.abs(y - from[1])];
  if (box[3] >= 8) smallest.value = box[3];
  draw();
});
window.addEventListener("mouseup", () => { from = null; });
canvas.addEventListener("click", event => {
  if (mode() === "polygon" && event.detail === 1) { open.push(at(event)); draw(); }
});
canvas.addEventListener("dblclick", () => {
  if (mode() !== "polygon") return;
  if (open.length >= 3) polygons.push(open);
  open = []; draw();
});
document.getElementById("undo").onclick = () => { open.length ? open.pop() : polygons.pop(); draw(); };
document.getElementById("clear").onclick = () => { polygons = []; open = []; box = null; smallest.value = ""; draw(); };
async function save(where) {
  if (open.length >= 3) { polygons.push(open); open = []; draw(); }
  const marks = { polygons: polygons, smallest: smallest.value === "" ? null : Number(smallest.value) };
  const answer = await fetch(where, { method: "POST", headers: { "Content-Type": "application/json" },
                                      body: JSON.stringify(marks) });
  said.textContent = (await answer.json()).said;
}
document.getElementById("save").onclick = () => save("/marks");
document.getElementById("done").onclick = () => save("/done");
image.onload = async () => {
  canvas.width = image.width; canvas.height = image.height;
  const marks = await (await fetch("/marks")).json();
  polygons = marks.polygons; smallest.value = marks.smallest ?? ""; draw();
};
image.src = "/picture.png";
</script></body></html>
"""
