# A STEP file of a unit cube with n x n plane faces on each side, as tessellations
# that were saved as CAD have them: awk -v n=27 -f facets.awk </dev/null
function e(text) { printf "#%d=%s;\n", ++id, text; return id }
function point(i, j, k) {
  if (!((i, j, k) in at))
    at[i, j, k] = e(sprintf("CARTESIAN_POINT('',(%.9g,%.9g,%.9g))", i / n,
                            j / n, k / n))
  return at[i, j, k]
}
function vector(kind, x, y, z) {
  return e(kind "('',(" x "," y "," z "))")
}
function axes(o, z, x) {
  return e("AXIS2_PLACEMENT_3D('',#" o ",#" z ",#" x ")")
}
function plane(x, y, z, nx, ny, nz) {
  return e("PLANE('',#" axes(vector("CARTESIAN_POINT", x, y, z),
                             vector("DIRECTION", nx, ny, nz),
                             vector("DIRECTION", ny, nz, nx)) ")")
}
function face(p, a, b, c, d,  loop, bound) {
  loop = e(sprintf("POLY_LOOP('',(#%d,#%d,#%d,#%d))", a, b, c, d))
  bound = e(sprintf("FACE_OUTER_BOUND('',#%d,.T.)", loop))
  faces = faces (faces == "" ? "" : ",") "#"
  faces = faces e(sprintf("FACE_SURFACE('',(#%d),#%d,.T.)", bound, p))
}
BEGIN {
  print "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');"
  print "FILE_NAME('facets','2026-11-25',(''),(''),'','','');"
  print "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));"
  print "ENDSEC;\nDATA;"
  for (s = 0; s < 3; s++) {
    x = (s == 0) "."; y = (s == 1) "."; z = (s == 2) "."
    low[s] = plane("0.", "0.", "0.", "-" x, "-" y, "-" z)
    high[s] = plane(x, y, z, x, y, z)
  }
  for (i = 0; i < n; i++)
    for (j = 0; j < n; j++) {
      face(low[2], point(i, j, 0), point(i, j + 1, 0),
           point(i + 1, j + 1, 0), point(i + 1, j, 0))
      face(high[2], point(i, j, n), point(i + 1, j, n),
           point(i + 1, j + 1, n), point(i, j + 1, n))
      face(low[1], point(i, 0, j), point(i + 1, 0, j),
           point(i + 1, 0, j + 1), point(i, 0, j + 1))
      face(high[1], point(i, n, j), point(i, n, j + 1),
           point(i + 1, n, j + 1), point(i + 1, n, j))
      face(low[0], point(0, i, j), point(0, i, j + 1),
           point(0, i + 1, j + 1), point(0, i + 1, j))
      face(high[0], point(n, i, j), point(n, i + 1, j),
           point(n, i + 1, j + 1), point(n, i, j + 1))
    }
  brep = e("FACETED_BREP('',#" e("CLOSED_SHELL('',(" faces "))") ")")
  axis = axes(vector("CARTESIAN_POINT", "0.", "0.", "0."),
              vector("DIRECTION", "0.", "0.", "1."),
              vector("DIRECTION", "1.", "0.", "0."))
  metre = e("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))")
  radian = e("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
  solid = e("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
  text = "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),#"
  within = e(text metre ",'distance_accuracy_value','')")
  text = "(GEOMETRIC_REPRESENTATION_CONTEXT(3)"
  text = text "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#" within "))"
  text = text "GLOBAL_UNIT_ASSIGNED_CONTEXT((#" metre ",#" radian ",#" solid "))"
  context = e(text "REPRESENTATION_CONTEXT('','3D'))")
  text = "FACETED_BREP_SHAPE_REPRESENTATION('',(#" axis ",#" brep "),#"
  shape = e(text context ")")
  use = e("APPLICATION_CONTEXT('mechanical design')")
  product = e("PRODUCT_CONTEXT('',#" use ",'mechanical')")
  product = e("PRODUCT('facets','facets','',(#" product "))")
  form = e("PRODUCT_DEFINITION_FORMATION('','',#" product ")")
  part = e("PRODUCT_DEFINITION_CONTEXT('part definition',#" use ",'design')")
  part = e("PRODUCT_DEFINITION('design','',#" form ",#" part ")")
  part = e("PRODUCT_DEFINITION_SHAPE('','',#" part ")")
  e("SHAPE_DEFINITION_REPRESENTATION(#" part ",#" shape ")")
  print "ENDSEC;\nEND-ISO-10303-21;"
}
