// The 3-D scene of a review package: draws the batch, and lets the arm move along the chosen way.
(() => {
  const { scene, motions } = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);
  const view = byId("view");
  const viewer = new MeshCat.Viewer(view);
  const { THREE } = MeshCat;
  viewer.gui.domElement.remove(); // meshcat's own control panel covers the view
  const resize = Object.getPrototypeOf(viewer).set_3d_pane_size.bind(viewer);
  viewer.set_3d_pane_size = () => resize(view.clientWidth, view.clientHeight);
  for (const name of ["Axes", "Grid"]) viewer.set_property([name], "visible", false);
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const backdrop = () => {
    viewer.scene.background = new THREE.Color(dark.matches ? 0x171b20 : 0xe9edf1);
    viewer.set_dirty();
  };
  dark.addEventListener("change", backdrop);
  backdrop();

  const bytes = Uint8Array.from(atob(scene), (letter) => letter.charCodeAt(0));
  const lengths = new DataView(bytes.buffer);
  for (let at = 0; at < bytes.length; ) {
    const length = lengths.getUint32(at, true);
    viewer.handle_command_bytearray(bytes.slice(at + 4, at + 4 + length));
    at += 4 + length;
  }
  // Seen through what stands before them: departures lie among the paths that they depart from.
  viewer.scene_tree.find(["departures"]).object.traverse((node) => {
    if (!node.material) return;
    Object.assign(node.material, { depthTest: false, transparent: true });
    node.renderOrder = 2;
  });
  viewer.set_3d_pane_size();
  viewer.camera.fov = 30;
  viewer.camera.position.set(1.95, 1.55, 1.8); // three's frame: y up
  viewer.controls.target.set(0.22, 0.5, 0);
  viewer.camera.updateProjectionMatrix();
  viewer.controls.update();
  new ResizeObserver(() => viewer.set_3d_pane_size()).observe(view);

  let motion = motions[0];
  let playing = false;
  const show = (share) => {
    const last = motion.times.length - 1;
    const at = Math.min(last, Math.max(0, share * last));
    const [low, high, part] = [Math.floor(at), Math.min(last, Math.floor(at) + 1), at % 1];
    const between = (a, b) => a.map((value, i) => value + part * (b[i] - value));
    for (const [i, pose] of motion.links[low].entries()) {
      viewer.set_transform(["robot", `link${i}`], between(pose, motion.links[high][i]));
    }
    if (motion.object) viewer.set_transform(["object"], between(motion.object[low], motion.object[high]));
    const now = motion.times[low] + part * (motion.times[high] - motion.times[low]);
    const segment = motion.segments.find((one) => now >= one.begin && now <= one.end);
    byId("said").textContent =
      `${now.toFixed(2)} of ${motion.times[last].toFixed(2)} s${segment ? `, ${segment.name}` : ""}`;
    byId("time").value = String(share);
    viewer.set_dirty();
  };
  const step = (before) => (now) => {
    if (!playing) return;
    const share = Math.min(1, Number(byId("time").value) + (now - before) / 1000 / motion.times.at(-1));
    show(share);
    if (share < 1) requestAnimationFrame(step(now));
    else play(false);
  };
  const play = (on) => {
    playing = on;
    byId("play").textContent = on ? "Pause" : "Play";
    if (on && Number(byId("time").value) >= 1) show(0);
    if (on) requestAnimationFrame((now) => step(now)(now));
  };
  if (motion) {
    byId("controls").hidden = false;
    byId("motion").replaceChildren(...motions.map((one, i) => new Option(one.name, i)));
    byId("motion").addEventListener("change", (event) => {
      motion = motions[Number(event.target.value)];
      show(0);
    });
    byId("play").addEventListener("click", () => play(!playing));
    byId("time").addEventListener("input", (event) => {
      play(false);
      show(Number(event.target.value));
    });
    show(0);
  }
  document.documentElement.dataset.report = "ready";
})();
