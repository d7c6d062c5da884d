/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reads faces and their names, colours and layers from STEP, IGES and BREP
 * files. */
#include "io/occt/occt_parts.h"

#include <cmath>
#include <fstream>

#include <sys/resource.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_CheckIterator.hxx>
#include <Interface_Static.hxx>
#include <NCollection_DataMap.hxx>
#include <NCollection_Map.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_Edge.hxx>
#include <StepShape_EdgeLoop.hxx>
#include <StepShape_FaceBound.hxx>
#include <StepShape_FaceSurface.hxx>
#include <StepShape_OrientedEdge.hxx>
#include <TColStd_HSequenceOfExtendedString.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

namespace vg_occt
{

namespace
{

struct Unit {
  const char *word, *open_cascade; /* name in reports; name in
                                      Interface_Static */
  double mm;
};
/* In the order of enum vg_cad_unit, without its first entry. */
const Unit units[] = { { "mm", "MM", 1 },        { "cm", "CM", 10 },
                       { "m", "M", 1000 },       { "km", "KM", 1e6 },
                       { "inch", "INCH", 25.4 }, { "foot", "FT", 304.8 } };
const int n_unit = sizeof units / sizeof *units;

TopoDS_Shape bare(const TopoDS_Shape &s)
{
  return s.Located(TopLoc_Location());
}

/* Remove the placeholders that CAD systems write instead of a name. */
std::string cleaned(std::string name)
{
  while (!name.empty() && static_cast<unsigned char>(name.back()) <= ' ')
    name.pop_back();
  name.erase(0, name.find_first_not_of(" \t"));
  return name == "NONE" || name == "None" || name.compare(0, 3, "=>[") == 0
         ? ""
         : name;
}

std::string text_of(const TCollection_ExtendedString &s)
{
  std::vector<char> utf8(static_cast<size_t>(s.LengthOfCString()) + 1);
  Standard_PCharacter to = utf8.data();

  s.ToUTF8CString(to);
  return cleaned(utf8.data());
}

std::string name_of(const Handle(Standard_Transient) & entity)
{
  Handle(StepRepr_RepresentationItem)
    item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
  Handle(IGESData_IGESEntity)
    iges = Handle(IGESData_IGESEntity)::DownCast(entity);
  Handle(TCollection_HAsciiString) name;

  if (!item.IsNull()) name = item->Name();
  else if (!iges.IsNull() && iges->HasName()) name = iges->NameValue();
  return name.IsNull() ? "" : cleaned(name->ToCString());
}

/* --- units --------------------------------------------------------------- */

/* The unit of the result. `given`: millimetres per unit of the file; 0: the
 * file has no unit. */
const Unit &choose_unit(const vg_cad_ask &ask, double given, const char *called,
                        Model &model, const Talk &talk)
{
  double own = given > 0 ? given : 1;
  const Unit *to = nullptr;

  for (const Unit &u : units)
    if (std::fabs(u.mm - own) < 1e-6 * own) to = &u;
  if (ask.unit > 0 && ask.unit <= n_unit) to = &units[ask.unit - 1];
  if (!to) {
    talk.note(format("lengths in the file are in %s, %.9g mm each; the "
                     "surface is in mm",
                     called, own));
    model.unit = 1;
    return units[0];
  }
  model.unit = static_cast<int>(to - units) + 1;
  if (!(given > 0))
    talk.note(format("the file names no unit of length; millimetres were "
                     "assumed, and the surface is in %s",
                     to->word));
  else if (std::fabs(to->mm - own) < 1e-6 * own)
    talk.note(format("lengths are in %s, the file's unit", to->word));
  else
    talk.note(format("lengths in the file, in %s (%.9g mm), were converted "
                     "to %s",
                     called, own, to->word));
  return *to;
}

double step_unit(STEPControl_Reader &reader, std::string &called)
{
  static const struct {
    const char *word;
    double metre;
  } prefix[] = { { "milli", 1 },  { "centi", 10 },   { "deci", 100 },
                 { "kilo", 1e6 }, { "micro", 1e-3 }, { "nano", 1e-6 } };
  TColStd_SequenceOfAsciiString length, angle, solid;

  reader.FileUnits(length, angle, solid);
  if (length.IsEmpty()) return 0;
  TCollection_AsciiString first = length.First();
  first.LowerCase();
  called = first.ToCString();
  if (called.find("inch") != std::string::npos) return 25.4;
  if (called.find("foot") != std::string::npos) return 304.8;
  if (called.find("met") == std::string::npos) return 0;
  for (const auto &p : prefix)
    if (called.find(p.word) != std::string::npos) return p.metre;
  return 1000;
}

/* --- attributes of shapes in a document --------------------------------- */

struct Said {
  std::string name, colour, layer;
};

/* Attributes of all shapes, without their locations in assemblies. Looking each
 * shape up in the document would take quadratic time. */
class Words
{
public:
  Words(const Handle(TDocStd_Document) & doc,
        const Handle(XSControl_WorkSession) & session)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(doc->Main())),
        colours_(XCAFDoc_DocumentTool::ColorTool(doc->Main())),
        layers_(XCAFDoc_DocumentTool::LayerTool(doc->Main()))
  {
    Handle(Interface_InterfaceModel) all = session->Model();
    Handle(Transfer_TransientProcess)
      done = session->TransferReader()->TransientProcess();

    for (int k = 1; k <= all->NbEntities(); k++) {
      Handle(Standard_Transient) entity = all->Value(k);
      std::string name = name_of(entity);

      if (!name.empty()) bind(TransferBRep::ShapeResult(done, entity), name);
    }
    take_document();
  }

  /* Null if the shape has no attributes. */
  const Said *of(const TopoDS_Shape &s) const
  {
    return said_.Seek(bare(s));
  }

  TDF_LabelSequence roots() const
  {
    TDF_LabelSequence list;

    shapes_->GetFreeShapes(list);
    return list;
  }

private:
  Said *at(const TopoDS_Shape &s)
  {
    if (!said_.IsBound(bare(s))) said_.Bind(bare(s), Said());
    return said_.ChangeSeek(bare(s));
  }

  void set_name(const TopoDS_Shape &s, const std::string &name)
  {
    Said *to = at(s);

    if (to->name.empty()) to->name = name;
  }

  /* All faces made from one entity have the entity's name. */
  void bind(const TopoDS_Shape &s, const std::string &name)
  {
    if (s.IsNull()) return;
    set_name(s, name);
    if (s.ShapeType() != TopAbs_SHELL) return;
    for (TopoDS_Iterator i(bare(s)); i.More(); i.Next())
      if (i.Value().ShapeType() == TopAbs_FACE) set_name(i.Value(), name);
  }

  void take_document()
  {
    TDF_LabelSequence list;

    shapes_->GetShapes(list);
    for (int k = 1; k <= list.Length(); k++) {
      TDF_LabelSequence parts;

      take_label(list.Value(k));
      XCAFDoc_ShapeTool::GetSubShapes(list.Value(k), parts);
      for (int j = 1; j <= parts.Length(); j++) take_label(parts.Value(j));
    }
  }

  void take_label(const TDF_Label &label)
  {
    static const XCAFDoc_ColorType kinds[] = { XCAFDoc_ColorSurf,
                                               XCAFDoc_ColorGen };
    Handle(TColStd_HSequenceOfExtendedString) list;
    Handle(TDataStd_Name) text;
    Quantity_Color c;
    TopoDS_Shape s;

    if (!XCAFDoc_ShapeTool::GetShape(label, s) || s.IsNull()) return;
    Said *to = at(s);
    if (label.FindAttribute(TDataStd_Name::GetID(), text))
      set_name(s, text_of(text->Get()));
    for (XCAFDoc_ColorType kind : kinds)
      if (to->colour.empty() && colours_->GetColor(label, kind, c))
        to->colour = Quantity_Color::ColorToHex(c).ToCString();
    if (layers_->GetLayers(label, list) && !list.IsNull() && !list->IsEmpty())
      to->layer = text_of(list->First());
  }

  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colours_;
  Handle(XCAFDoc_LayerTool) layers_;
  NCollection_DataMap<TopoDS_Shape, Said, TopTools_ShapeMapHasher> said_;
};

/* Collects the faces of a shape, in order, each once. Faces without attributes
 * get those of their solid. */
class Collector
{
public:
  Collector(Model &model, const Words *words) : model_(model), words_(words)
  {
  }

  void add(const TopoDS_Shape &s, Face from)
  {
    if (words_) inherit(s, from);
    if (s.ShapeType() == TopAbs_SOLID) {
      from.solid = model_.n_solid++;
      model_.solid_names.push_back(from.part);
    }
    if (s.ShapeType() == TopAbs_FACE) {
      if (int known = seen_.FindIndex(s)) {
        Face &same = model_.faces[static_cast<size_t>(known) - 1];

        if (same.solid != from.solid) same.behind = from.solid;
        return;
      }
      seen_.Add(s);
      from.number = static_cast<uint32_t>(seen_.Extent());
      from.shape = TopoDS::Face(s);
      model_.faces.push_back(from);
    } else if (s.ShapeType() == TopAbs_EDGE) {
      model_.loose.push_back(TopoDS::Edge(s));
    } else if (s.ShapeType() < TopAbs_EDGE) {
      for (TopoDS_Iterator i(s); i.More(); i.Next()) add(i.Value(), from);
    }
  }

private:
  void inherit(const TopoDS_Shape &s, Face &from) const
  {
    const Said *said = words_->of(s);

    if (!said) return;
    if (s.ShapeType() == TopAbs_FACE) from.name = said->name;
    else if (!said->name.empty()) from.part = said->name;
    if (!said->colour.empty()) from.colour = said->colour;
    if (!said->layer.empty()) from.layer = said->layer;
  }

  Model &model_;
  const Words *words_;
  TopTools_IndexedMapOfShape seen_;
};

Handle(TDocStd_Document) new_document()
{
  Handle(TDocStd_Document) doc;

  XCAFDoc_ShapeTool::SetAutoNaming(Standard_False); /* such as "COMPOUND" */
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", doc);
  return doc;
}

void collect(const Words &words, Model &model)
{
  Collector to(model, &words);
  TDF_LabelSequence roots = words.roots();

  for (int k = 1; k <= roots.Length(); k++) {
    TopoDS_Shape s;

    if (XCAFDoc_ShapeTool::GetShape(roots.Value(k), s) && !s.IsNull())
      to.add(s, Face());
  }
}

/* Entities of a list of checks that failed: their number and the first of
 * them. */
struct Failed {
  size_t n = 0;
  std::string first;

  Failed(Interface_CheckIterator all,
         const Handle(Interface_InterfaceModel) & model)
  {
    for (all.Start(); all.More(); all.Next()) {
      if (!all.Value()->HasFailed() || all.Number() <= 0) continue;
      Handle(Standard_Transient) entity = model->Value(all.Number());
      Handle(IGESData_IGESEntity)
        iges = Handle(IGESData_IGESEntity)::DownCast(entity);

      if (!n++)
        first = format("%s%s: %s", model->StringLabel(entity)->ToCString(),
                       iges.IsNull()
                         ? ""
                         : format(" (type %d)", iges->TypeNumber()).c_str(),
                       without_format(all.Value()->CFail(1)).c_str());
    }
  }

private:
  /* Open CASCADE leaves format specifications in some messages. */
  static std::string without_format(std::string text)
  {
    for (size_t at; (at = text.find("%d ")) != std::string::npos;)
      text.erase(at, 3);
    return text;
  }
};

Interface_CheckIterator checks_of_transfer(const Handle(XSControl_WorkSession) &
                                           session)
{
  return session->TransferReader()->TransientProcess()->CheckList(
    Standard_True);
}

/* Report entities that Open CASCADE could not convert to shapes. */
void note_failures(const Handle(XSControl_WorkSession) & session,
                   const Talk &talk)
{
  const Failed failed(checks_of_transfer(session), session->Model());

  if (failed.n)
    talk.note(format("%zu entities of the file could not be translated, the "
                     "first is %.300s",
                     failed.n, failed.first.c_str()));
}

/* Nothing of the file could be converted: name the entity that is damaged, or
 * the first one that has no shape. */
Failure not_converted(const Handle(XSControl_WorkSession) & session,
                      const char *kind)
{
  Failed failed(session->ModelCheckList(), session->Model());

  if (!failed.n) failed = Failed(checks_of_transfer(session), session->Model());
  return Failure{
    VG_ERR_INPUT,
    format("this %s file could not be converted to a shape%s", kind,
           failed.n
             ? format(": %zu of its entities %s wrong, the first is %.300s; "
                      "export it again",
                      failed.n, failed.n == 1 ? "is" : "are",
                      failed.first.c_str())
                 .c_str()
             : ": it has no faces or solids that Open CASCADE knows; export "
               "trimmed surfaces or solids")
  };
}

void require(IFSelect_ReturnStatus got, const char *kind)
{
  if (got == IFSelect_RetDone) return;
  throw Failure{ VG_ERR_FORMAT,
                 format("Open CASCADE cannot read this %s file (%s); it is "
                        "damaged or not a file of this kind: export it again",
                        kind,
                        got == IFSelect_RetVoid ? "it is empty"
                                                : "its syntax is wrong") };
}

/* Open CASCADE needs 27 kB per face, so this many need 8 GB. */
const size_t MOST_FACES = 300000;

void refuse_too_many(size_t n)
{
  if (n <= MOST_FACES) return;
  throw Failure{ VG_ERR_UNSUPPORTED,
                 format("it has %zu faces, more than the limit of %zu that "
                        "Open CASCADE's memory use allows; if it is a "
                        "tessellation saved as CAD, read it from STL or OBJ "
                        "instead",
                        n, MOST_FACES) };
}

bool names_face(const std::string &word)
{
  const std::string tail = "_FACE";

  return word == "FACE_SURFACE" ||
         (word.size() > tail.size() &&
          !word.compare(word.size() - tail.size(), tail.size(), tail));
}

/* Count faces before a STEP file is read: the reader searches a list for each
 * of its items, so that a shell of a million faces would take hours. */
size_t count_step_faces(const std::string &path)
{
  std::ifstream in(path, std::ios::binary);
  std::string word;
  size_t n = 0;
  char c;

  while (in.get(c))
    if ((c >= 'A' && c <= 'Z') || c == '_') word += c;
    else {
      n += c == '(' && names_face(word);
      if (c != ' ') word.clear();
    }
  return n;
}

/* Count trimmed and bounded surfaces and faces of solids. */
size_t count_iges_faces(const Handle(IGESData_IGESModel) & file)
{
  size_t n = 0;

  for (int i = 1; i <= file->NbEntities(); i++) {
    const int type = file->Entity(i)->TypeNumber();

    n += type == 144 || type == 143 || type == 510;
  }
  return n;
}

/* While it exists, this process opens no file. The translators of Open CASCADE
 * would read the files that a file names, from anywhere. */
class NoOtherFile
{
public:
  NoOtherFile()
  {
    getrlimit(RLIMIT_NOFILE, &was_);
    rlimit none = was_;
    none.rlim_cur = 0;
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoOtherFile()
  {
    setrlimit(RLIMIT_NOFILE, &was_);
  }
  NoOtherFile(const NoOtherFile &) = delete;
  NoOtherFile &operator=(const NoOtherFile &) = delete;

private:
  rlimit was_;
};

/* Translate the file that the reader has read. */
template <typename Reader>
bool transfer(Reader &reader, Handle(TDocStd_Document) & doc)
{
  const NoOtherFile guard;

  return reader.Transfer(doc);
}

/* --- faces on the wrong side of their border ----------------------------- */

/* A closed curve divides a sphere or a torus into two parts that are both
 * finite. Loops in STEP files may also run along the seam to a pole and back:
 *
 *        pole o         Open CASCADE 7.6 drops these edges in some cases. It
 *             | seam    can then take the other part of the sphere, reverse
 *         .---o---.     it to match its neighbours, and call the result valid,
 *        ( border  )    although the body lacks, for example, a whole ball.
 *         '-------'
 */

bool has_two_finite_sides(const TopoDS_Face &face)
{
  const GeomAbs_SurfaceType type = BRepAdaptor_Surface(face).GetType();

  return type == GeomAbs_Sphere || type == GeomAbs_Torus;
}

/* Whether a loop of the entity runs along an edge in both directions. */
bool has_seam(const Handle(StepShape_FaceSurface) & face)
{
  NCollection_Map<Handle(Standard_Transient)> seen;

  for (int i = 1; i <= face->NbBounds(); i++) {
    Handle(StepShape_EdgeLoop) loop = Handle(StepShape_EdgeLoop)::DownCast(
      face->BoundsValue(i)->Bound());
    if (loop.IsNull()) continue;
    for (int k = 1; k <= loop->NbEdgeList(); k++)
      if (!seen.Add(loop->EdgeListValue(k)->EdgeElement())) return true;
  }
  return false;
}

bool has_seam(const TopoDS_Face &face)
{
  for (TopExp_Explorer at(face, TopAbs_EDGE); at.More(); at.Next())
    if (BRep_Tool::IsClosed(TopoDS::Edge(at.Current()), face)) return true;
  return false;
}

[[noreturn]] void refuse_side(const TopoDS_Face &face, const char *label)
{
  Bnd_Box box;
  double lo[3], hi[3];

  BRepBndLib::Add(face, box);
  box.Get(lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]);
  throw Failure{
    VG_ERR_GEOMETRY,
    format("face %s is part of a sphere or torus around (%.6g, %.6g, %.6g), "
           "and Open CASCADE drops the seam in its border, so that it may take "
           "the wrong side of the border: divide this face into two in the CAD "
           "system, or export the model as BREP or IGES",
           label, (lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2, (lo[2] + hi[2]) / 2)
  };
}

void refuse_dropped_seams(const Handle(XSControl_WorkSession) & session)
{
  Handle(Interface_InterfaceModel) model = session->Model();
  Handle(Transfer_TransientProcess)
    done = session->TransferReader()->TransientProcess();

  for (int k = 1; k <= model->NbEntities(); k++) {
    Handle(StepShape_FaceSurface)
      entity = Handle(StepShape_FaceSurface)::DownCast(model->Value(k));
    if (entity.IsNull()) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(done, entity);
    if (shape.IsNull()) continue;
    for (TopExp_Explorer at(shape, TopAbs_FACE); at.More(); at.Next()) {
      const TopoDS_Face face = TopoDS::Face(at.Current());

      if (has_two_finite_sides(face) && !has_seam(face) && has_seam(entity))
        refuse_side(face, model->StringLabel(entity)->ToCString());
    }
  }
}

/* --- formats ------------------------------------------------------------- */

void read_step(const vg_cad_ask &ask, const std::string &path, Model &model,
               const Talk &talk)
{
  STEPCAFControl_Reader reader;
  Handle(TDocStd_Document) doc = new_document();
  std::string called = "a unit of its own";
  double given;

  reader.SetNameMode(Standard_True);
  reader.SetColorMode(Standard_True);
  reader.SetLayerMode(Standard_True);
  refuse_too_many(count_step_faces(path));
  require(reader.ReadFile(path.c_str()), "STEP");
  given = step_unit(reader.ChangeReader(), called);
  Interface_Static::SetCVal(
    "xstep.cascade.unit",
    choose_unit(ask, given, called.c_str(), model, talk).open_cascade);
  talk.stage("translating its entities");
  if (!transfer(reader, doc)) throw not_converted(reader.Reader().WS(), "STEP");
  if (!reader.ExternFiles().IsEmpty())
    talk.note(format("the file refers to %d other files, which are never read: "
                     "export the assembly as a single file",
                     static_cast<int>(reader.ExternFiles().Size())));
  note_failures(reader.Reader().WS(), talk);
  refuse_dropped_seams(reader.Reader().WS());
  collect(Words(doc, reader.Reader().WS()), model);
}

void read_iges(const vg_cad_ask &ask, const std::string &path, Model &model,
               const Talk &talk)
{
  IGESCAFControl_Reader reader;
  Handle(TDocStd_Document) doc = new_document();
  Handle(IGESData_IGESModel) file;
  double given = 0;

  reader.SetNameMode(Standard_True);
  reader.SetColorMode(Standard_True);
  reader.SetLayerMode(Standard_True);
  /* The reader scales by this setting, which an earlier file may have
   * changed. */
  Interface_Static::SetCVal("xstep.cascade.unit", units[0].open_cascade);
  require(reader.ReadFile(path.c_str()), "IGES");
  file = reader.IGESModel();
  if (!file.IsNull()) {
    refuse_too_many(count_iges_faces(file));
    given = file->GlobalSection().UnitValue();
    const Unit &to = choose_unit(ask, given, "its unit", model, talk);
    Interface_Static::SetCVal("xstep.cascade.unit", to.open_cascade);
    file->ChangeGlobalSection().SetCascadeUnit(to.mm);
  }
  talk.stage("translating its entities");
  if (!transfer(reader, doc)) throw not_converted(reader.WS(), "IGES");
  note_failures(reader.WS(), talk);
  collect(Words(doc, reader.WS()), model);
}

bool load_brep(const std::string &path, TopoDS_Shape &shape)
{
  BRep_Builder builder;

  try {
    return BRepTools::Read(shape, path.c_str(), builder) && !shape.IsNull();
  } catch (const Standard_Failure &) {
    return false; /* its result is of no use */
  }
}

/* A BREP file has neither units nor names. */
void read_brep(const vg_cad_ask &ask, const std::string &path, Model &model,
               const Talk &talk)
{
  TopoDS_Shape shape;

  if (!load_brep(path, shape))
    throw Failure{ VG_ERR_FORMAT, "Open CASCADE cannot read this BREP file; it "
                                  "is truncated or damaged: export it again" };
  refuse_too_many(count_faces(shape, MOST_FACES + 1));
  model.unit = ask.unit;
  talk.note(ask.unit > 0 && ask.unit <= n_unit
              ? format("a BREP file has no unit of length: its numbers are "
                       "taken to be in %s (unit) and are not scaled",
                       units[ask.unit - 1].word)
              : "a BREP file has no unit of length: its numbers are not "
                "scaled");
  Collector(model, nullptr).add(shape, Face());
}

} // namespace

void read(const vg_cad_ask &ask, const std::string &path, Model &model,
          const Talk &talk)
{
  mend_large_shells();
  if (ask.kind == 1) read_step(ask, path, model, talk);
  else if (ask.kind == 2) read_iges(ask, path, model, talk);
  else read_brep(ask, path, model, talk);
  if (ask.section && !model.loose.empty()) return;
  if (model.faces.empty() && !model.loose.empty())
    throw Failure{ VG_ERR_INPUT,
                   format("there are no faces in it, only %zu curves; if they "
                          "are a plane section, for a mesh in two dimensions, "
                          "give --cad-section yes, otherwise export solids or "
                          "surfaces",
                          model.loose.size()) };
  if (model.faces.empty())
    throw Failure{ VG_ERR_INPUT, "there are no faces in it, only points or "
                                 "curves, or nothing at all; export solids "
                                 "or surfaces" };
}

} // namespace vg_occt
