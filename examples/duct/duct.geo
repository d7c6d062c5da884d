// An S-duct of circular section with straight ends: diameter 100 mm, offset
// 100 mm. `gmsh -0 duct.geo` writes duct.step.
SetFactory("OpenCASCADE");
Point(1) = {0, 0, 0};
Point(2) = {200, 0, 0};
Point(3) = {350, 0, 0};
Point(4) = {350, 0, 100};
Point(5) = {500, 0, 100};
Point(6) = {800, 0, 100};
Line(1) = {1, 2};
Bezier(2) = {2, 3, 4, 5};
Line(3) = {5, 6};
Wire(1) = {1, 2, 3};
Disk(1) = {0, 0, 0, 50};
Rotate {{0, 1, 0}, {0, 0, 0}, Pi/2} { Surface{1}; }
Extrude { Surface{1}; } Using Wire {1}
Delete { Surface{1}; }
Save "duct.step";
