/* Files of hydrodynamic data and meshes go from the browser straight to REST; what it answered goes to a store. */
(function () {
  "use strict";
  const set = (id, props) => window.dash_clientside.set_props(id, props);

  function choose(accept, several) {
    return new Promise((resolve) => {
      const input = document.createElement("input");
      Object.assign(input, { type: "file", accept, multiple: several, hidden: true, id: "sd-file" });
      input.addEventListener("change", () => {
        input.remove();
        resolve([...input.files]);
      });
      input.addEventListener("cancel", () => {
        input.remove();
        resolve([]);
      });
      document.body.appendChild(input);
      input.click();
    });
  }

  async function send(path, form, button, store) {
    set(button, { loading: true });
    let told;
    try {
      const answer = await fetch(path, { method: "POST", body: form, credentials: "same-origin" });
      const body = await answer.json();
      told = answer.ok ? body : { problem: body };
    } catch (error) {
      told = { problem: { title: "Not uploaded", detail: "The service does not answer. Try again." } };
    }
    set(button, { loading: false });
    set(store, { data: { ...told, at: Date.now() } });
  }

  const WAMIT = ["length", "density", "gravity", "depth", "centre_of_mass"];

  function uploadData(_clicks, name, values, ...fields) {
    choose("", true).then((files) => {
      if (!files.length) return;
      const form = new FormData();
      files.forEach((file) => form.append("file", file));
      if (name) form.append("name", name);
      const given = WAMIT.map((field, index) => [field, (fields[index] || "").trim()]).filter(([, text]) => text);
      given.forEach(([field, text]) => form.append(field, text));
      if (given.length || values === "dimensional") form.append("values", values);
      send("/api/v1/data-sets", form, "data-upload", "data-added");
    });
    return "asked";
  }

  function uploadMesh() {
    choose(".stl,.gdf,.msh,.dat", false).then((files) => {
      if (!files.length) return;
      const form = new FormData();
      form.append("file", files[0]);
      form.append("name", files[0].name);
      send("/api/v1/hydrodynamics/meshes", form, "mesh-upload", "mesh-added");
    });
    return "asked";
  }

  window.dash_clientside = window.dash_clientside || {};
  window.dash_clientside.slowdrift = Object.assign(window.dash_clientside.slowdrift || {}, { uploadData, uploadMesh });
})();
