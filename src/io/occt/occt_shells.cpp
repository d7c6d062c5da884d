/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Open CASCADE's repair of translated shapes, except that the orientation of
 * faces is omitted in shells of very many faces, where Open CASCADE searches
 * all faces for each face. */
#include "io/occt/occt_parts.h"

#include <ShapeFix_Shape.hxx>
#include <ShapeFix_Shell.hxx>
#include <ShapeFix_Solid.hxx>
#include <ShapeFix_Face.hxx>
#include <ShapeFix_Wire.hxx>
#include <ShapeProcess_ShapeContext.hxx>
#include <TopExp_Explorer.hxx>
#include <XSAlgo.hxx>
#include <XSAlgo_AlgoContainer.hxx>

namespace vg_occt
{
namespace
{

const size_t MANY = 4000; /* takes 2 s; the time grows as the square */

class Mending : public XSAlgo_AlgoContainer
{
public:
  TopoDS_Shape ProcessShape(const TopoDS_Shape &shape, const double precision,
                            const double most, const char *resource,
                            const char *sequence,
                            Handle(Standard_Transient) & info,
                            const Message_ProgressRange &progress,
                            const bool non_manifold) const override;
};

/* The default processing of Open CASCADE. */
TopoDS_Shape Mending::ProcessShape(const TopoDS_Shape &shape,
                                   const double precision, const double most,
                                   const char *resource, const char *sequence,
                                   Handle(Standard_Transient) & info,
                                   const Message_ProgressRange &progress,
                                   const bool non_manifold) const
{
  if (count_faces(shape, MANY + 1) <= MANY)
    return XSAlgo_AlgoContainer::ProcessShape(shape, precision, most, resource,
                                              sequence, info, progress,
                                              non_manifold);
  Handle(ShapeProcess_ShapeContext)
    context = new ShapeProcess_ShapeContext(shape, "");
  Handle(ShapeFix_Shape) fix = new ShapeFix_Shape(shape);

  context->SetNonManifold(non_manifold);
  fix->SetPrecision(precision);
  fix->SetMaxTolerance(most);
  fix->FixFaceTool()->FixWireTool()->FixSameParameterMode() = 0;
  fix->FixSolidTool()->CreateOpenSolidMode() = Standard_False;
  fix->FixSolidTool()->FixShellTool()->FixOrientationMode() = 0;
  fix->FixShellTool()->FixOrientationMode() = 0;
  fix->Perform(progress);
  if (!fix->Shape().IsNull() && !fix->Shape().IsSame(shape)) {
    context->RecordModification(fix->Context());
    context->SetResult(fix->Shape());
  }
  info = context;
  return context->Result();
}

} // namespace

size_t count_faces(const TopoDS_Shape &shape, size_t most)
{
  size_t n = 0;

  for (TopExp_Explorer e(shape, TopAbs_FACE); e.More() && n < most; e.Next())
    n++;
  return n;
}

void mend_large_shells()
{
  XSAlgo::Init(); /* otherwise it would later replace our function by its own */
  XSAlgo::SetAlgoContainer(new Mending);
}

} // namespace vg_occt
