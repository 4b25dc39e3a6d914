// A gear with twelve teeth and a round hole.
SetFactory("Built-in");
Mesh.Algorithm = 6;
size = 0.17;
Point(1) = {0, 0, 0, size};
For k In {0:3}
  Point(2 + k) = {0.3 * Cos(k * Pi / 2), 0.3 * Sin(k * Pi / 2), 0, size};
EndFor
For k In {0:3}
  Circle(1 + k) = {2 + k, 1, 2 + (k + 1) % 4};
EndFor
// Each tooth: two points on the circle of radius 0.8, two on that of radius 1.
For k In {0:11}
  angle = k * Pi / 6;
  Point(10 + 4 * k) = {0.8 * Cos(angle - 0.17), 0.8 * Sin(angle - 0.17), 0, size};
  Point(11 + 4 * k) = {1.0 * Cos(angle - 0.09), 1.0 * Sin(angle - 0.09), 0, size};
  Point(12 + 4 * k) = {1.0 * Cos(angle + 0.09), 1.0 * Sin(angle + 0.09), 0, size};
  Point(13 + 4 * k) = {0.8 * Cos(angle + 0.17), 0.8 * Sin(angle + 0.17), 0, size};
EndFor
For k In {0:47}
  Line(10 + k) = {10 + k, 10 + (k + 1) % 48};
EndFor
Curve Loop(1) = {10:57};
Curve Loop(2) = {1:4};
Plane Surface(1) = {1, 2};
Physical Curve("teeth") = {10:57};
Physical Curve("hole") = {1:4};
Physical Surface("gear") = {1};
