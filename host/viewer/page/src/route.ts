// A path of the hand around the models.

import * as THREE from 'three';

/** The models to go around. */
export interface Obstacles {
  /** Contains all models. */
  ball(): THREE.Sphere;
  isClear(from: THREE.Vector3, to: THREE.Vector3): boolean;
}

const ASIDE = 1.15; // of the ball's radius
const STEP = Math.PI / 10;

/** Places to visit on the path from one place to another; none if the straight line is clear. */
export function routeTo(models: Obstacles, from: THREE.Vector3, to: THREE.Vector3): THREE.Vector3[] {
  if (models.isClear(from, to)) return [];
  const { center, radius } = models.ball();
  const a = directionFrom(center, from);
  const b = directionFrom(center, to);
  const least = ASIDE * radius;
  const outer = Math.max(least, from.distanceTo(center));
  const inner = Math.max(least, to.distanceTo(center));
  const turn = new THREE.Quaternion().setFromUnitVectors(a, b);
  const steps = Math.max(1, Math.ceil(a.angleTo(b) / STEP));
  return Array.from({ length: steps + 1 }, (_, i) => {
    const part = new THREE.Quaternion().slerp(turn, i / steps);
    const distance = outer + ((inner - outer) * i) / steps;
    return a.clone().applyQuaternion(part).multiplyScalar(distance).add(center);
  });
}

function directionFrom(centre: THREE.Vector3, place: THREE.Vector3): THREE.Vector3 {
  const direction = place.clone().sub(centre);
  return direction.lengthSq() > 0 ? direction.normalize() : new THREE.Vector3(0, 0, 1);
}
