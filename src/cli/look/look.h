/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/look/look.h: examines the surface of a project for the portal, in a
 * process of its own, since reading CAD may take long or crash. Uses run/input,
 * cli/scene. */
#ifndef VG_CLI_LOOK_LOOK_H
#define VG_CLI_LOOK_LOOK_H

/** Files in the current folder: the settings, the result, and the 3-D view
 * (vg_scene_pack with one array, the first kind of defect of each triangle, or
 * VG_LOOK_SOUND). */
#define VG_LOOK_DECK "look.deck"
#define VG_LOOK_JSON "look.json"
#define VG_LOOK_SCENE "look.scene"

enum { VG_LOOK_SOUND = 255 };

enum vg_look_kind {
  VG_LOOK_VIEW, /* The surface as it is in the file: no remeshing, no wrap. */
  VG_LOOK_CHECK /* The surface that a run with these settings meshes. */
};

/** Read and check a project with the settings in VG_LOOK_DECK and write the
 * other two files; a refused surface has a view as well. Progress is written to
 * stderr, a line each second. Prints the message of a failure that leaves no
 * result, such as a file that cannot be read.
 * @param project  as for vanguard mesh
 * Returns the exit status: VG_EXIT_DONE also for a refused surface. */
int vg_look(enum vg_look_kind kind, const char *project);

#endif
