// Meshes that were dropped but not yet sent: the file, what it looks like, its size, the parameters.
import { getLimits } from "./api.js";
import { bytes } from "./format.js";
import { Observable } from "./listeners.js";
import { materialOf, offeredScale } from "./materials.js";
import { Guides } from "./guides.js";
import { MeshError } from "./mesh/read_mesh.js";
import { inspectFile } from "./worker/client.js";
import { recall } from "./prefs.js";

export const ACCEPTED = ".stl,.obj,.ply,.off,model/stl,model/obj";

class Drafts extends Observable {
  list = [];
  current = 0;

  /**
   * Begins a draft for each file; earlier drafts go. `like` = {tag, scale, values, guides} of an earlier job to begin
   * with; guides as they travel. Material and values are those of all, size and drawing of each.
   */
  open(files, like = null) {
    const material = recall("material", "card");
    const values = { e_max: materialOf(material).tolerance, ...(like?.values ?? recall("values", {})) };
    this.list = [...files].map((file) => makeDraft(file, like, material, values));
    this.current = 0;
    for (const draft of this.list) this.read(draft);
    this.changed();
  }

  async read(draft) {
    try {
      await this.checkSize(draft.file);
      draft.mesh = await inspectFile(draft.file);
      draft.up = draft.up ?? guessUp(draft.mesh);
      if (!draft.like) offerSize(draft);
    } catch (error) {
      draft.error = error;
    }
    this.changed();
  }

  /** Refuses what the server would refuse, before anything is read or sent. */
  async checkSize(file) {
    this.limits ??= await getLimits().catch(() => null);
    const most = this.limits?.uploadBytes;
    if (most && file.size > most) {
      throw new MeshError(
        `The file has ${bytes(file.size)}; this server takes ${bytes(most)} at most.`,
        "",
        "Reduce the mesh: 20,000 to 200,000 triangles are plenty for sheets.",
      );
    }
  }

  get draft() {
    return this.list[this.current] ?? null;
  }

  select(k) {
    this.current = k;
    this.changed();
  }
}

export const drafts = new Drafts();

function makeDraft(file, like, material, values) {
  return {
    file,
    name: file.name,
    mesh: null,
    error: null,
    like,
    up: null,
    guides: new Guides(like?.guides),
    tag: like?.tag ?? "",
    scale: like?.scale ?? 1,
    material,
    values,
  };
}

/** A file whose own millimetres cannot be meant begins at a size that fits on a table; `draft.offered` tells. */
function offerSize(draft) {
  const longest = Math.max(...extents(draft.mesh));
  const scale = offeredScale(longest);
  if (scale === null) return;
  draft.scale = scale;
  draft.offered = { scale, longest };
}

/** The ways a shape may stand: the axis of the mesh that points up. */
export const UPS = ["z", "y", "x", "-z", "-y", "-x"];

/** STL comes from CAD and printing, where z is up; in OBJ, PLY and OFF it is mostly y. Samples say so in their name. */
export function guessUp({ format }) {
  return format === "stl" ? "z" : "y";
}

/** Extents of the box in units of the file. */
export const extents = (mesh) => mesh.box.max.map((high, axis) => high - mesh.box.min[axis]);
export const diagonal = (mesh) => Math.hypot(...extents(mesh));
