// The records of a scene file, from the root down: parts and materials, time, loads, output and pictures.
#include <pliant/body/distributed/distributed_force.h>
#include <pliant/scene/schema/scene_schema.h>

#include <pliant/method/error_scale.h>
#include <pliant/part/registry.h>
#include <pliant/scene/point_value.h>
#include <pliant/scene/time_value.h>
#include <pliant/simulate/choose_integrator.h>

#include "drive_schema.h"
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
  std::vector<Choice> all{
      {kAutomatic, "chosen by trial for a \"tolerance\": the method that advances farthest at equal cost"}};
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
                        required("at", material_point(), "The material point.", "{\"u\": 0, \"v\": 0}")}};
  const Record in_world{
      "in_world",
      "A point of the world, fixed or moving.",
      {required("world", time_vector("m"), "Position; each coordinate may change in time.", "[0, 0, 1]")}};
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
                    "A rotation about an axis of the world.",
                    {required("axis", vector3("1"), "Direction of the axis.", "[0, 1, 0]"),
                     required("angle", number(unbounded(), "rad"), "Angle, right-handed.", "1.5708")}};
  return one_of({record(quaternion), record(axis)})
      .expecting("{\"quaternion\": [w, x, y, z]} or {\"axis\": [x, y, z], \"angle\": radians}");
}

/// Returns the record of a part or a material: the fields `more`, then the fields that parts and materials
/// share.
Record damping_fields(std::string record_name, std::string description, std::vector<Field> more) {
  std::vector<Field> fields = std::move(more);
  fields.push_back(optional("density", number(above(0), "kg/m^3"),
                            "Mass per rest volume; for a shell, mass per rest area (kg/m^2).", "1000"));
  fields.push_back(optional("elasticity", elasticity_type(),
                            "Elastic material of a part without local deformation. Its strain energy acts on "
                            "the dynamic parameters, in addition to their stiffnesses."));
  fields.push_back(optional("alpha", number(at_least(0), "1/s"),
                            "Damping of the parameters in proportion to mass: D = alpha M + beta K.", "0"));
  fields.push_back(optional("beta", number(at_least(0), "s"),
                            "Damping of the parameters in proportion to stiffness.", "0"));
  fields.push_back(
      optional("drag", number(at_least(0), "1/s"), "Damping of the whole motion: D = nu M.", "0"));
  return {std::move(record_name), std::move(description), std::move(fields)};
}

Record stiffness_matrix_record() {
  return {"stiffness_matrix",
          "A full stiffness matrix of several parameters.",
          {required("parameters", array(name(), 1), "The parameters, in the order of the rows.",
                    "[\"a1\", \"a2\"]"),
           required("K", array(array(number(unbounded(), "1"), 1), 1),
                    "Symmetric matrix without negative eigenvalues; SI units.", "[[2, 1], [1, 2]]")}};
}

Record inertia_record() {
  return {"inertia",
          "Mass and inertia of a rigid part, instead of its density.",
          {required("mass", number(above(0), "kg"), "Mass.", "1"),
           required("moments", array(array(number(unbounded(), "kg m^2"), 3, 3), 3, 3),
                    "Inertia tensor about the origin of the body frame, body axes.",
                    "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"),
           optional("centre", vector3("m"), "Centre of mass in the body frame.", "[0, 0, 0]")}};
}

Record motion_record() {
  const Record turn{
      "turn",
      "A rotation in time, applied after the orientation of the part.",
      {optional("axis", vector3("1"), "Direction of the axis through the origin of the body frame, world.",
                "[0, 0, 1]"),
       required("angle", time_function("rad"), "Angle, right-handed.", "\"3 * t\"")}};
  return {"motion",
          "A prescribed motion, which no force changes.",
          {optional("position", time_vector("m"),
                    "Position of the origin of the body frame; when absent, the position of the part."),
           optional("turn", record(turn), "Rotation; when absent, the part does not rotate.")}};
}

Record part_record() {
  Record part = damping_fields(
      "part", "A deformable solid primitive.",
      {required("name", name(), "Name, unique in the scene.", "\"ball\""),
       required("shape", choice(shape_choices()), "The solid primitive e(u; a).", "\"superellipsoid\""),
       optional("deformations", array(choice(deformation_choices()), 0, 16),
                "Global deformations T, applied in this order. A type may be repeated; the names of the "
                "parameters then begin with taper, taper2, ...",
                "[]"),
       optional("parameters", map(parameter_type()),
                "Global parameters by name, for example a1 of the shape or taper.tx of a deformation. See "
                "`pliant list`.",
                "{}"),
       optional("stiffness_matrix", record(stiffness_matrix_record()),
                "A full stiffness matrix K_s of several parameters."),
       optional("material", name(), "Name of an entry of materials; keys of the part take precedence."),
       optional("shell", boolean(), "Whether all mass is on the surface; the density is then per area.",
                "false"),
       optional("thickness", number(above(0), "m"),
                "Thickness of a shell. The density is then per volume (kg/m^3)."),
       optional("local", record(local_record()), "Local deformation; when absent, there is none."),
       optional("mass", number(above(0), "kg"), "Total mass, instead of the density."),
       optional(
           "mass_matrix",
           choice(
               {{"consistent", "M of Eq. (11)"},
                {"diagonal",
                 "only the diagonal of M, as in section 5 of the paper. For comparisons: energy and momenta "
                 "are not conserved, and bodies whose centre of mass is not the origin fall wrongly"}}),
           "Mass matrix from which accelerations follow.", "\"consistent\""),
       optional(
           "mass_distribution", text(1).expecting("a formula of X, Y, Z, u, v and w"),
           "Formula that multiplies the density at each material point. X, Y, Z: the place at rest in the "
           "frame of the part (m). u, v (rad) and w: the material coordinates."),
       optional("inertia", record(inertia_record()), "Mass and inertia of a rigid part."),
       optional("position", vector3("m"), "Position of the origin of the body frame at time 0.", "[0, 0, 0]"),
       optional("orientation", orientation(), "Orientation of the body frame at time 0.",
                "{\"quaternion\": [1, 0, 0, 0]}"),
       optional("velocity", vector3("m/s"), "Velocity of the origin at time 0, world.", "[0, 0, 0]"),
       optional("angular_velocity", vector3("rad/s"), "Angular velocity at time 0, body frame.", "[0, 0, 0]"),
       optional("fixed", boolean(), "Whether the part never moves.", "false"),
       optional("motion", record(motion_record()),
                "Prescribed motion; the part then has no degrees of freedom."),
       optional("color", color(), "Colour in pictures; when absent, a colour of a palette."),
       optional("resolution", integer(between(1, 128)),
                "Edges n of the surface mesh along an eighth of a circle: 48 n^2 triangles, or 64 n^2 for a "
                "torus.",
                "8"),
       optional("visible", boolean(), "Whether pictures and meshes show the part.", "true")});
  part.exclusive = {{{"density", "mass", "inertia"}}, {{"fixed", "motion"}}};
  return part;
}

Record time_record() {
  return {
      "time",
      "Duration of the run and method of time integration.",
      {optional("end", number(at_least(0), "s"), "End of the run; it starts at 0.", "1"),
       optional("step", number(above(0), "s"),
                "Fixed time step, for a scene without \"tolerance\" whose integrator is not \"auto\".",
                "0.001"),
       optional("integrator", choice(integrator_choices()),
                "Method of time integration. When absent, it is \"semi_implicit_euler\" in a scene with "
                "\"step\" and without \"tolerance\", otherwise \"auto\"."),
       optional("tolerance", number(between(kMinTolerance, kMaxTolerance), "1"),
                "Bound on the error of a step, which then controls the step length. Its unit is the size "
                "of the part for lengths and the radian for angles; for rates it is this unit per "
                "time T, or per a shorter time scale of the part. T is 10 / rate with the \"rate\" of "
                "\"stabilization\", normally 1 s. When absent, the tolerance "
                "is 1e-6 with the integrator \"auto\"; with the others all steps have the length \"step\"."),
       optional(
           "stop_rate", number(at_least(0), "1/s"),
           "No step crosses a multiple of 1 / stop_rate. The viewer writes this key in the scenes that it "
           "saves.",
           "0"),
       optional("solver",
                choice({{"auto", "chosen by a fixed cost model for each set of parts that joints connect"},
                        {"blocks", "blocks of C_q M^-1 C_q^T"},
                        {"augmented", "the sparse matrix of the paper's Eq. (14)"}}),
                "Method for the constraint forces of joints.", "\"auto\"")}};
}

Record spring_record() {
  return {
      "spring",
      "A linear spring and damper between two points. With rest length 0 the damper resists all relative "
      "motion, otherwise only motion along the line of the spring. A formula or key frames make it a muscle.",
      {optional("name", name(), "Name in the outputs."),
       required("from", end_point(), "First end.", "{\"world\": [0, 0, 1]}"),
       required("to", end_point(), "Second end.", "{\"part\": \"ball\", \"at\": {\"u\": 1.5708, \"v\": 0}}"),
       required("stiffness", state_function("N/m", at_least(0)), "Stiffness.", "100"),
       optional("damping", state_function("N s/m", at_least(0)), "Damping.", "0"),
       optional("rest_length", state_function("m", at_least(0)), "Length without force.", "0"),
       optional("on", number(at_least(0), "s"), "Time at which the spring begins to act.", "0"),
       optional("off", number(above(0), "s"),
                "Time at which the spring ceases to act; when absent, never.")}};
}

Type frame_type() {
  return choice(
      {{"world", "components along the world's axes"}, {"body", "components along the part's axes"}});
}

Record force_record() {
  return {"force",
          "A force at a material point.",
          {optional("name", name(), "Name in the outputs."),
           required("part", name(), "Name of the part.", "\"ball\""),
           required("at", material_point(), "Point of application.", "{\"u\": 0, \"v\": 0}"),
           required("force", state_vector("N"), "The force.", "[0, 0, \"10 * sin(t)\"]"),
           optional("frame", frame_type(), "Axes of its components.", "\"world\"")}};
}

Record torque_record() {
  return {"torque",
          "A torque on a part.",
          {optional("name", name(), "Name in the outputs."),
           required("part", name(), "Name of the part.", "\"ball\""),
           optional("against", name(),
                    "Name of the part on which the opposite torque acts, for a motor or a muscle between two "
                    "parts. When absent, the torque is external."),
           required("torque", state_vector("N m"), "The torque.", "[0, 0, 1]"),
           optional("frame", frame_type(), "Axes of its components.", "\"world\"")}};
}

Record surface_force_record() {
  return {
      "surface_force",
      "A force per area on the present surface of a part, for example wind or buoyancy. Its formulas also "
      "read quantities of the point. x, y, z: the point. vx, vy, vz: its velocity. nx, ny, nz: the outward "
      "normal. vn: the velocity along it. X, Y, Z: the place at rest in the frame of the part.",
      {optional("name", name(), "Name in the outputs."),
       required("part", name(), "Name of the part.", "\"wing\""),
       optional("traction", state_vector("N/m^2"), "The force per area, along the world's axes.",
                "[0, 0, 0]"),
       optional("pressure", state_function("Pa", unbounded()),
                "Pressure, whose force is along the inward normal, for example \"9810 * max(-z, 0)\".", "0"),
       optional("resolution", integer(between(1, DistributedForce::kMaxResolution)),
                "Number of edges of triangles along an eighth of a circle. A part with \"local\" has the "
                "triangles of its mesh.",
                std::to_string(DistributedForce::kSurfaceResolution))}};
}

Record body_force_record() {
  return {"body_force",
          "A force per mass in a part. Its formulas also read quantities of the point. x, y, z: the point. "
          "vx, vy, vz: its velocity. X, Y, Z: the place at rest in the frame of the part.",
          {optional("name", name(), "Name in the outputs."),
           required("part", name(), "Name of the part.", "\"ball\""),
           required("acceleration", state_vector("m/s^2"), "The force per mass, along the world's axes.",
                    "[\"-4 * x\", 0, 0]"),
           optional("resolution", integer(between(3, DistributedForce::kMaxResolution)),
                    "Number of points along each direction of a smooth piece of the shape. A part with nodes "
                    "or modes has the nodes of its mesh.",
                    std::to_string(DistributedForce::kBodyResolution))}};
}

Record track_record() {
  return {"track",
          "A material point whose path is drawn and recorded. A state is recorded whenever the point has "
          "moved by more "
          "than 2 % of the size of its part, also between two pictures.",
          {optional("name", name(), "Name in the outputs."),
           required("part", name(), "Name of the part.", "\"ball\""),
           required("at", material_point(), "The point.", "{\"u\": 0, \"v\": 0}"),
           optional("color", color(), "Colour of the line.", "\"#d03020\"")}};
}

Record sensor_record() {
  return {
      "sensor",
      "A named quantity, which trajectory.csv records and formulas may read.",
      {required("name", name(), "Name in formulas and outputs.", "\"height\""),
       required("value", state_function("", unbounded()),
                "Its value: a formula of t, of parts (ball.x, y, z, vx, vy, vz, omega.x, PARAMETER, "
                "PARAMETER_dot), joints (angle, position, twist, swing_y, swing_z, length, rate), springs "
                "(length, rate), tracks (x, y, z, vx, vy, vz) and of the sensors before it.",
                "\"ball.z\"")}};
}

Record output_record() {
  return {
      "output",
      "Recorded states, tables and pictures.",
      {optional("frame_rate", number(above(0), "1/s"), "Recorded states and pictures per second.", "25"),
       optional("size", array(integer(between(16, 8192)), 2, 2), "Width and height of pictures, pixels.",
                "[640, 480]"),
       optional("every_part", boolean(),
                "Whether trajectory.csv has columns for every part and joint, in addition to tracks and "
                "totals. When absent, it has them in scenes of at most 100 parts."),
       optional(
           "contacts", boolean(),
           "Whether contacts.csv and joint_impulses.csv are written. They list the contacts of the last step "
           "before each recorded state with their impulses, and the joint impulses that balance the contact "
           "impulses.",
           "false")}};
}

Record camera_record() {
  return {"camera",
          "Camera of the pictures; when absent, it is chosen from the motion.",
          {optional("eye", vector3("m"), "Position of the camera."),
           optional("target", vector3("m"), "Point in the middle of the picture."),
           optional("field_of_view", number(between(5, 120), "degrees"), "Vertical field of view.", "35")}};
}

Record light_record() {
  return {"light",
          "The main light.",
          {optional("direction", vector3("1"), "Direction towards the light."),
           optional("shadows", boolean(), "Whether it casts shadows.", "true")}};
}

Record ground_record() {
  return {"ground",
          "The drawn ground. Parts do not touch it; planes of \"contact\" stop them.",
          {optional("visible", boolean(), "Whether it is drawn.", "true"),
           optional("height", number(unbounded(), "m"),
                    "Height z; when absent, just below the lowest point of the motion.")}};
}

Record make_scene_record() {
  const Record material = damping_fields("material", "Properties that several parts can share.", {});
  return {
      "scene",
      "A scene of pliant. SI units, z up, right-handed; angles in radians. Keys \"//\" and x-... are "
      "ignored.",
      {optional("name", name(), "Name of the scene; when absent, the name of the file."),
       optional("description", text(), "The behaviour that the scene demonstrates.", "\"\""),
       optional("gravity", time_vector("m/s^2"), "Acceleration of gravity; it may change in time.",
                "[0, 0, -9.81]"),
       optional("time", record(time_record()), "Duration of the run and method of time integration.", "{}"),
       optional("materials", map(record(material)), "Materials by name.", "{}"),
       required("parts", array(record(part_record())), "The parts: deformable solid primitives.",
                "[{\"name\": \"ball\", \"shape\": \"sphere\"}]"),
       optional("joints", array(joint_type(end_point(), orientation())),
                "Joints between parts or to the world.", "[]"),
       optional("stabilization", record(stabilization_record()),
                "Method that closes open joints and keeps them closed.", "{}"),
       optional("contact", record(contact_record(orientation(), color())),
                "Contact of parts, planes and obstacles; when absent, there is no contact."),
       optional("springs", array(record(spring_record())), "Springs between parts or to the world.", "[]"),
       optional("forces", array(record(force_record())), "Forces at material points.", "[]"),
       optional("torques", array(record(torque_record())), "Torques on parts.", "[]"),
       optional("surface_forces", array(record(surface_force_record())), "Forces per area on surfaces.",
                "[]"),
       optional("body_forces", array(record(body_force_record())), "Forces per mass.", "[]"),
       optional("sensors", array(record(sensor_record())),
                "Named quantities that are recorded and that formulas may read.", "[]"),
       optional("tracks", array(record(track_record())), "Material points whose paths are recorded.", "[]"),
       optional("output", record(output_record()), "Recorded states, tables and pictures.", "{}"),
       optional("coloring", record(coloring_record()), "Colours of parts by their deformation."),
       optional("camera", record(camera_record()), "Camera of the pictures.", "{}"),
       optional("light", record(light_record()), "The main light.", "{}"),
       optional("ground", record(ground_record()), "The drawn ground.", "{}")}};
}

}  // namespace

const Type& parameter_type() {
  static const Type type =
      one_of(
          {number(unbounded(), "m, rad or 1"),
           record(
               {"parameter",
                "A global parameter. It is dynamic, a degree of freedom, if \"dynamic\" is true, or if an "
                "initial value, an initial rate, a stiffness, a drive or a row of \"stiffness_matrix\" is "
                "given. "
                "Otherwise it is frozen at its rest value.",
                {optional("rest", time_function("m, rad or 1"),
                          "Rest value; for a dynamic parameter it may change in time."),
                 optional("dynamic", boolean(), "Whether it is a degree of freedom.", "false"),
                 optional("initial", number(unbounded(), "m, rad or 1"),
                          "Value at time 0; when absent, the rest value."),
                 optional("initial_rate", number(unbounded(), "m/s, rad/s or 1/s"), "Rate at time 0.", "0"),
                 optional("stiffness", number(at_least(0), "N/m for a length, else N m"),
                          "K of the energy 1/2 K (q - rest)^2.", "0"),
                 optional("drive", record(parameter_drive_record()),
                          "Servo, spring or motor on the parameter, which is then dynamic."),
                 optional("min", number(unbounded(), "m, rad or 1"), "Lower limit of a dynamic parameter."),
                 optional("max", number(unbounded(), "m, rad or 1"),
                          "Upper limit of a dynamic parameter.")}})})
          .expecting(
              "a number or {\"rest\", \"dynamic\", \"initial\", \"initial_rate\", \"stiffness\", "
              "\"drive\", \"min\", \"max\"}")
          .defined_as("parameter_value");
  return type;
}

const Record& scene_record() {
  static const Record record = make_scene_record();
  return record;
}

}  // namespace pliant
