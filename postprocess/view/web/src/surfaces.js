// What cells lie on: the sphere or a plane, which offer the same to the rest of the page.

import { Plane } from "./plane.js";
import { Sphere } from "./sphere.js";

export const surfaceOf = (mesh) => (mesh.plane ? new Plane(mesh) : new Sphere(mesh));
