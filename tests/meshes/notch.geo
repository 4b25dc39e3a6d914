// A box with a notch in its upper edge.
SetFactory("Built-in");
size = 0.5;
Point(1) = {0, 0, 0, size};
Point(2) = {2, 0, 0, size};
Point(3) = {2, 1, 0, size};
Point(4) = {1.3, 1, 0, size};
Point(5) = {1, 0.5, 0, size};
Point(6) = {0.7, 1, 0, size};
Point(7) = {0, 1, 0, size};
For k In {1:7}
  Line(k) = {k, 1 + k % 7};
EndFor
Curve Loop(1) = {1:7};
Plane Surface(1) = {1};
body[] = Extrude {0, 0, 1} { Surface{1}; };
Physical Volume("box") = {body[1]};
Physical Surface("walls") = {1, body[0], body[2], body[3], body[4], body[7], body[8]};
Physical Surface("notch") = {body[5], body[6]};
