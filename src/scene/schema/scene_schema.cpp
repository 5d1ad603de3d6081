#include <pliant/scene/schema/scene_schema.h>

#include <pliant/method/error_scale.h>
#include <pliant/part/registry.h>
#include <pliant/scene/point_value.h>
#include <pliant/scene/time_value.h>
#include <pliant/simulate/choose_integrator.h>

#include "joint_schema.h"
#include "local_schema.h"
#include "scene/reader/coloring_reader.h"
#include "scene/reader/contact_reader.h"

namespace pliant {

namespace {

using namespace schema;

std::vector<Choice> shape_choices() {
  std::vector<Choice> all;
  for (const auto& shape : all_shapes()) all.push_back({shape->name(), shape->formula()});
  return all;
}
std::vector<Choice> deformation_choices() {
  std::vector<Choice> all;
  for (const DeformationInfo& info : all_deformations()) all.push_back({info.name, info.formula});
  return all;
}
std::vector<Choice> integrator_choices() {
  std::vector<Choice> all{{kAutomatic, "by trial, what comes farthest at a cost; to a \"tolerance\""}};
  for (const IntegratorInfo& info : all_integrators()) all.push_back({info.name, info.description});
  return all;
}

Type color() {
  Type hex = text(7)
                 .checked([](const JsonValue& value, const ReportAt& report) {
                   const std::string& s = value.string();
                   if (s.size() != 7 || s[0] != '#' ||
                       s.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
                     report(value, "expected \"#rrggbb\" with hexadecimal digits", kWholeValue);
                 })
                 .matching("^#[0-9a-fA-F]{6}$")
                 .expecting("\"#rrggbb\" or [red, green, blue] from 0 to 1");
  return one_of({hex, array(number(between(0, 1), "1"), 3, 3)})
      .expecting("a colour \"#rrggbb\" or [red, green, blue] from 0 to 1 (sRGB)")
      .defined_as("color");
}

Type end_point() {
  const Record on_part{"on_part",
                       "A material point of a part.",
                       {required("part", name(), "Name of the part.", "\"ball\""),
                        required("at", material_point(), "Where on it.", "{\"u\": 0, \"v\": 0}")}};
  const Record in_world{
      "in_world",
      "A point of the world, fixed or moving.",
      {required("world", time_vector("m"), "Position; each coordinate may move in time.", "[0, 0, 1]")}};
  return one_of({record(on_part), record(in_world)})
      .expecting("{\"part\": name, \"at\": material point} or {\"world\": [x, y, z]}")
      .defined_as("end_point");
}

Type orientation() {
  const Record quaternion{
      "by_quaternion",
      "A unit quaternion, body to world.",
      {required("quaternion", array(number(unbounded(), "1"), 4, 4).expecting("4 numbers [w, x, y, z]"),
                "w, x, y, z.", "[1, 0, 0, 0]")}};
  const Record axis{"by_axis",
                    "A turn about an axis of the world.",
                    {required("axis", vector3("1"), "The axis.", "[0, 1, 0]"),
                     required("angle", number(unbounded(), "rad"), "The angle, right-handed.", "1.5708")}};
  return one_of({record(quaternion), record(axis)})
      .expecting("{\"quaternion\": [w, x, y, z]} or {\"axis\": [x, y, z], \"angle\": radians}");
}

Record damping_fields(std::string record_name, std::string description, std::vector<Field> more) {
  std::vector<Field> fields = std::move(more);
  fields.push_back(optional("density", number(above(0), "kg/m^3"),
                            "Mass per rest volume; of a shell per rest area (kg/m^2).", "1000"));
  fields.push_back(optional("elasticity", elasticity_type(),
                            "Elastic material of a part without local deformation: the strain energy of its "
                            "dynamic parameters, instead of stiffnesses or beside them."));
  fields.push_back(optional("alpha", number(at_least(0), "1/s"),
                            "Damping of the parameters in proportion to mass: D = alpha M + beta K.", "0"));
  fields.push_back(optional("beta", number(at_least(0), "s"),
                            "Damping of the parameters in proportion to stiffness.", "0"));
  fields.push_back(optional("drag", number(at_least(0), "1/s"), "Damping of all motion: D = nu M.", "0"));
  return {std::move(record_name), std::move(description), std::move(fields)};
}

Record part_record() {
  const Record stiffness{"stiffness_matrix",
                         "A full stiffness matrix over some parameters.",
                         {required("parameters", array(name(), 1),
                                   "The parameters, in the order of the rows.", "[\"a1\", \"a2\"]"),
                          required("K", array(array(number(unbounded(), "1"), 1), 1),
                                   "Symmetric, no negative eigenvalue; SI units.", "[[2, 1], [1, 2]]")}};
  const Record inertia{"inertia",
                       "Mass and inertia of a rigid part, instead of its density.",
                       {required("mass", number(above(0), "kg"), "Mass.", "1"),
                        required("moments", array(array(number(unbounded(), "kg m^2"), 3, 3), 3, 3),
                                 "Inertia tensor about the origin of the body frame, body axes.",
                                 "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"),
                        optional("centre", vector3("m"), "Centre of mass in the body frame.", "[0, 0, 0]")}};
  const Record turn{
      "turn",
      "A turn in time, after the part's orientation.",
      {optional("axis", vector3("1"), "Axis through the origin of the body frame, world.", "[0, 0, 1]"),
       required("angle", time_function("rad"), "Right-handed.", "\"3 * t\"")}};
  const Record motion{"motion",
                      "How a part is moved, whatever pushes it.",
                      {optional("position", time_vector("m"),
                                "Of the origin of the body frame; where the part is placed when not given."),
                       optional("turn", record(turn), "How it turns; not at all when not given.")}};
  Record part = damping_fields(
      "part", "A deformable solid primitive.",
      {required("name", name(), "Name, unique in the scene.", "\"ball\""),
       required("shape", choice(shape_choices()), "The solid primitive e(u; a).", "\"superellipsoid\""),
       optional("deformations", array(choice(deformation_choices()), 0, 16),
                "Global deformations T, applied in this order; a type may come again (taper, taper2, ...).",
                "[]"),
       optional("parameters", map(parameter_type()),
                "Global parameters by name: those of the shape, then link.parameter. See `pliant list`.",
                "{}"),
       optional("stiffness_matrix", record(stiffness), "A full K_s over some parameters."),
       optional("material", name(), "Name of an entry of materials; keys given here take precedence."),
       optional("shell", boolean(), "Mass on the surface only; the density is then per area.", "false"),
       optional("thickness", number(above(0), "m"),
                "Of a shell: its density is then per volume (kg/m^3), and times this per area."),
       optional("local", record(local_record()), "Local deformation; none when not given."),
       optional("mass", number(above(0), "kg"), "Total mass, instead of the density."),
       optional("inertia", record(inertia), "Mass and inertia of a rigid part."),
       optional("position", vector3("m"), "Origin of the body frame at time 0.", "[0, 0, 0]"),
       optional("orientation", orientation(), "Of the body frame at time 0.",
                "{\"quaternion\": [1, 0, 0, 0]}"),
       optional("velocity", vector3("m/s"), "Of the origin at time 0, world.", "[0, 0, 0]"),
       optional("angular_velocity", vector3("rad/s"), "At time 0, body frame.", "[0, 0, 0]"),
       optional("fixed", boolean(), "The part does not move.", "false"),
       optional("motion", record(motion), "The part moves as prescribed, and has no degrees of freedom."),
       optional("color", color(), "Colour in pictures; from a palette when not given."),
       optional("resolution", integer(between(1, 128)),
                "Edges along an eighth of a circle of its surface mesh (48 n^2 triangles).", "8"),
       optional("visible", boolean(), "Whether pictures and meshes show it.", "true")});
  part.exclusive = {{{"density", "mass", "inertia"}}, {{"fixed", "motion"}}};
  return part;
}

Record make_scene_record() {
  const Record time{
      "time",
      "How long, and how to step.",
      {optional("end", number(at_least(0), "s"), "End of the run; it starts at 0.", "1"),
       optional("step", number(above(0), "s"), "Time step.", "0.001"),
       optional("integrator", choice(integrator_choices()), "Method of time integration.",
                "\"semi_implicit_euler\""),
       optional(
           "tolerance", number(between(kLeastTolerance, kGreatestTolerance), "1"),
           "Error of a step, in sizes of each part and radians, and of their rates; steps are then as long "
           "as it lets them be. Not given: all are \"step\" long."),
       optional("solver",
                choice({{"auto", "what a fixed model of the cost says, for each island of parts"},
                        {"blocks", "blocks of C_q M^-1 C_q^T"},
                        {"augmented", "the sparse matrix of the paper's Eq. (14)"}}),
                "How the forces of joints are found.", "\"auto\"")}};
  const Record spring{"spring",
                      "A linear spring and damper between two points. With rest length 0 its damper resists "
                      "all relative motion, else "
                      "only along its line.",
                      {optional("name", name(), "Name in the outputs."),
                       required("from", end_point(), "One end.", "{\"world\": [0, 0, 1]}"),
                       required("to", end_point(), "The other end.",
                                "{\"part\": \"ball\", \"at\": {\"u\": 1.5708, \"v\": 0}}"),
                       required("stiffness", number(at_least(0), "N/m"), "Stiffness.", "100"),
                       optional("damping", number(at_least(0), "N s/m"), "Damping.", "0"),
                       optional("rest_length", number(at_least(0), "m"), "Length without force.", "0")}};
  const auto frame =
      choice({{"world", "components along the world's axes"}, {"body", "along the part's axes"}});
  const Record force{"force",
                     "A force at a material point.",
                     {optional("name", name(), "Name in the outputs."),
                      required("part", name(), "Name of the part.", "\"ball\""),
                      required("at", material_point(), "Where it acts.", "{\"u\": 0, \"v\": 0}"),
                      required("force", time_vector("N"), "The force.", "[0, 0, \"10 * sin(t)\"]"),
                      optional("frame", frame, "Axes of its components.", "\"world\"")}};
  const Record torque{"torque",
                      "A torque on a part.",
                      {optional("name", name(), "Name in the outputs."),
                       required("part", name(), "Name of the part.", "\"ball\""),
                       optional("against", name(),
                                "Name of the part on which the opposite torque acts, as of a motor or a "
                                "muscle between the two; when not given, the torque is from outside."),
                       required("torque", time_vector("N m"), "The torque.", "[0, 0, 1]"),
                       optional("frame", frame, "Axes of its components.", "\"world\"")}};
  const Record track{"track",
                     "A material point whose path is drawn and written.",
                     {optional("name", name(), "Name in the outputs."),
                      required("part", name(), "Name of the part.", "\"ball\""),
                      required("at", material_point(), "The point.", "{\"u\": 0, \"v\": 0}"),
                      optional("color", color(), "Colour of the line.", "\"#d03020\"")}};
  const Record output{
      "output",
      "What is recorded and drawn.",
      {optional("frame_rate", number(above(0), "1/s"), "Recorded states and frames per second.", "25"),
       optional("size", array(integer(between(16, 8192)), 2, 2), "Width and height of frames, pixels.",
                "[640, 480]"),
       optional(
           "every_part", boolean(),
           "Whether trajectory.csv has columns of every part and joint, beside those of tracks and totals; "
           "when not given it has in scenes of at most 100 parts."),
       optional(
           "contacts", boolean(),
           "Whether contacts.csv and joint_impulses.csv tell of the last step before each recorded state "
           "what touched, with which impulse, and what joints took up of it.",
           "false")}};
  const Record camera{
      "camera",
      "From where frames are seen; found from the motion when not given.",
      {optional("eye", vector3("m"), "Position."), optional("target", vector3("m"), "Point in the middle."),
       optional("field_of_view", number(between(5, 120), "degrees"), "Vertical.", "35")}};
  const Record light{"light",
                     "The key light.",
                     {optional("direction", vector3("1"), "Towards the light."),
                      optional("shadows", boolean(), "Whether it casts shadows.", "true")}};
  const Record ground{
      "ground",
      "The drawn ground; it does not touch the parts, planes of \"contact\" do.",
      {optional("visible", boolean(), "Whether it is drawn.", "true"),
       optional("height", number(unbounded(), "m"), "Its z; just below the motion when not given.")}};
  const Record material = damping_fields("material", "What parts can share.", {});
  return {"scene",
          "A scene of pliant. SI units, z up, right-handed; angles in radians. Keys \"//\" and x-... are "
          "ignored.",
          {optional("name", name(), "Name of the scene; that of the file when not given."),
           optional("description", text(), "What the scene shows.", "\"\""),
           optional("gravity", time_vector("m/s^2"), "Acceleration of gravity; it may change in time.",
                    "[0, 0, -9.81]"),
           optional("time", record(time), "How long, and how to step.", "{}"),
           optional("materials", map(record(material)), "Materials by name.", "{}"),
           required("parts", array(record(part_record())), "The bodies.",
                    "[{\"name\": \"ball\", \"shape\": \"sphere\"}]"),
           optional("joints", array(joint_type(end_point(), orientation())),
                    "Joints between parts or to the world.", "[]"),
           optional("stabilization", record(stabilization_record()), "How joints close and hold.", "{}"),
           optional("contact", record(contact_record(orientation(), color())),
                    "What touches what; nothing when not given."),
           optional("springs", array(record(spring)), "Springs between parts or to the world.", "[]"),
           optional("forces", array(record(force)), "Forces at material points.", "[]"),
           optional("torques", array(record(torque)), "Torques on parts.", "[]"),
           optional("tracks", array(record(track)), "Motion tracks.", "[]"),
           optional("output", record(output), "What is recorded and drawn.", "{}"),
           optional("coloring", record(coloring_record()), "Parts coloured by how they are deformed."),
           optional("camera", record(camera), "From where frames are seen.", "{}"),
           optional("light", record(light), "The key light.", "{}"),
           optional("ground", record(ground), "The drawn ground.", "{}")}};
}

}  // namespace

const Type& parameter_type() {
  static const Type type =
      one_of(
          {number(unbounded(), "m, rad or 1"),
           record(
               {"parameter",
                "A global parameter. It is dynamic, a degree of freedom, when it says so or has an "
                "initial value, a "
                "rate or a stiffness; else frozen at its rest value.",
                {optional("rest", time_function("m, rad or 1"),
                          "Rest value; of a dynamic parameter it may move in time."),
                 optional("dynamic", boolean(), "Whether it is a degree of freedom.", "false"),
                 optional("initial", number(unbounded(), "m, rad or 1"),
                          "Value at time 0; the rest value when not given."),
                 optional("initial_rate", number(unbounded(), "m/s, rad/s or 1/s"), "Rate at time 0.", "0"),
                 optional("stiffness", number(at_least(0), "N/m for a length, else N m"),
                          "K of the energy 1/2 K (q - rest)^2.", "0"),
                 optional("min", number(unbounded(), "m, rad or 1"), "Lower limit of a dynamic parameter."),
                 optional("max", number(unbounded(), "m, rad or 1"),
                          "Upper limit of a dynamic parameter.")}})})
          .expecting(
              "a number, or {\"rest\", \"dynamic\", \"initial\", \"initial_rate\", \"stiffness\", \"min\", "
              "\"max\"}")
          .defined_as("parameter_value");
  return type;
}

const Record& scene_record() {
  static const Record record = make_scene_record();
  return record;
}

}  // namespace pliant
