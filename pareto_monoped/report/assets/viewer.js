// The exported CAD of the selected design, turned with the mouse, a finger or the arrow keys; plain WebGL 2.

function program(gl) {
  const made = gl.createProgram();
  for (const [kind, id] of [[gl.VERTEX_SHADER, "vertex"], [gl.FRAGMENT_SHADER, "fragment"]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, byId(id).textContent);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  return gl.getProgramParameter(made, gl.LINK_STATUS) ? made : null;
}

const solid = { turn: -0.7, tilt: 0.35, zoom: 1, draw: () => {} };

function showModel(box, model, name) {
  const canvas = make("canvas", { tabindex: 0, role: "img", "aria-label": `${name} in three dimensions; turn it with the arrow keys, plus and minus to zoom` });
  box.append(canvas, small(`${model.note} Drag or use the arrow keys to turn it; + and -, or the wheel after a click on it, zoom.`));
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  const made = gl && program(gl);
  if (!made) {
    box.replaceChildren(small("This browser shows no WebGL 2: open the exported GLB or STEP file in a CAD viewer."));
    return;
  }
  const corners = new Int16Array(bytesOf(model.positions).buffer);
  const tints = bytesOf(model.colours);
  const ends = [0, 1, 2].map((k) => extent(corners.filter((_, i) => i % 3 === k)));
  const middle = ends.map(([low, high]) => (low + high) / 2);
  const size = Math.hypot(...ends.map(([low, high]) => high - low)) / 2 || 1;
  const positions = Float32Array.from(corners, (v, i) => (v - middle[i % 3]) / size);
  const colours = Float32Array.from(corners, (_, i) => tints[3 * Math.floor(i / 9) + i % 3] / 255);
  gl.useProgram(made);
  for (const [attribute, values] of [["position", positions], ["tint", colours]]) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    const at = gl.getAttribLocation(made, attribute);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 0, 0);
  }
  gl.enable(gl.DEPTH_TEST);
  solid.draw = () => {
    const scale = window.devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * scale;
    canvas.height = canvas.clientHeight * scale;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const [c, s, d, t] = [Math.cos(solid.turn), Math.sin(solid.turn), Math.cos(solid.tilt), Math.sin(solid.tilt)];
    const z = solid.zoom;
    // World z is up: turn about it, then tilt towards the viewer; columns of the matrix.
    gl.uniformMatrix4fv(gl.getUniformLocation(made, "view"), false, [c * z, s * t * z, -s * d, 0, -s * z, c * t * z, -c * d, 0, 0, d * z, t, 0, 0, 0, 0, 1].map((v, i) => (i % 4 === 2 ? -v : v)));
    gl.uniform1f(gl.getUniformLocation(made, "aspect"), canvas.width / canvas.height);
    gl.drawArrays(gl.TRIANGLES, 0, corners.length / 3);
  };
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => { if (event.buttons) moveModel(event.movementX / 120, event.movementY / 120); });
  canvas.addEventListener("wheel", (event) => {
    // The page scrolls over it, unless it has the focus.
    if (document.activeElement !== canvas) return;
    event.preventDefault();
    moveModel(0, 0, event.deltaY < 0 ? 1.1 : 1 / 1.1);
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15], "+": [0, 0, 1.15], "-": [0, 0, 1 / 1.15] }[event.key];
    if (!step) return;
    event.preventDefault();
    moveModel(...step);
  });
  solid.draw();
}

function moveModel(turn, tilt, nearer = 1) {
  solid.turn += turn;
  solid.tilt = Math.min(Math.max(solid.tilt + tilt, -1.5), 1.5);
  solid.zoom = Math.min(Math.max(solid.zoom * nearer, 0.5), 12);
  solid.draw();
}

function startViewer() {
  const box = byId("viewer");
  on("selection", () => {
    box.replaceChildren();
    solid.draw = () => {};
    const chosen = subject();
    if (chosen?.model) {
      showModel(box, chosen.model, `Trial ${chosen.number}`);
      return;
    }
    box.append(small("No CAD of this design was given to the report. Export it with the command above, then make the report with --exports and the folder."));
    const exported = Object.keys(current().models);
    if (!exported.length) return;
    const line = small("Exported: ");
    for (const number of exported) line.append(buttonOf(`trial ${number}`, () => select(state.study, current().trials.trial.indexOf(Number(number)))), " ");
    box.append(line);
  });
  window.addEventListener("resize", () => solid.draw());
}
