# A real VGRID project meshes as it is.
[ -d "${VG_DATA_DIR:-}/vgrid_box" ] || skip "VG_DATA_DIR has no vgrid_box"
for suffix in d3m front mapbc; do
  cp "$VG_DATA_DIR/vgrid_box/box.$suffix" .
done
vanguard mesh -q -p box
exits 0
says out "validity: valid"
says out "the .d3m asks for viscous layers"
exists box.cogsg box.bc box.b8.ugrid
same box.mapbc "$VG_DATA_DIR/vgrid_box/box.mapbc"
same box.front "$VG_DATA_DIR/vgrid_box/box.front"
vanguard check -q "$VG_DATA_DIR/vgrid_box/box.cogsg"
exits 0
says out "validity: valid"
