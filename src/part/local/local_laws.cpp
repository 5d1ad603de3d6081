// The registry of the laws of local deformation.
#include <pliant/part/local/local_laws.h>

#include <stdexcept>

#include <pliant/local/shell/bending.h>
#include <pliant/local/shell/hinges.h>
#include <pliant/local/shell/linear_membrane.h>
#include <pliant/local/shell/loaded_membrane.h>
#include <pliant/local/shell/membrane.h>
#include <pliant/local/shell/membrane_laws.h>
#include <pliant/local/shell/pressure.h>
#include <pliant/local/solid/make_solid_energy.h>
#include <pliant/part/mesh/parameter_mesh.h>

namespace pliant {

namespace {

using Number = LocalLawInfo::Number;
using Energy = std::unique_ptr<NodalEnergy>;

const Number kYoung{"E", "Pa", "Young's modulus.", 0, true};
const Number kPoissonShell{"nu", "1", "Poisson's ratio.", -1, true, 0.3, 0.5};
const Number kPoissonSolid{"nu", "1", "Poisson's ratio, below 1/2.", -1, true, 0.3, 0.4999999};
const Number kPoissonLogShell{"nu", "1", "Poisson's ratio.", 0, false, 0.3, 0.5};
const Number kPoissonLogSolid{"nu", "1", "Poisson's ratio, below 1/2.", 0, false, 0.3, 0.4999999};
const Number kThickness{"thickness", "m", "Thickness of the sheet.", 0, true};

ShellMesh shell(const LocalMesh& mesh) {
  return ShellMesh(mesh.X, mesh.triangles);
}
Sheet sheet(const double* values) {
  return {values[0], values[1], values[2]};
}

template <class Law>
Energy membrane_energy(const LocalMesh& mesh, const double* values) {
  return std::make_unique<Membrane<Law>>(shell(mesh), sheet(values));
}
template <class Hinges>
Energy bending_energy(const LocalMesh& mesh, const double* values) {
  return std::make_unique<MidEdgeBending<Hinges>>(shell(mesh), sheet(values), mesh.density);
}
template <SolidLaw law>
Energy solid_energy(const LocalMesh& mesh, const double* values) {
  return make_solid_energy(law, mesh.X, mesh.tetrahedra, Elasticity(values[0], values[1]));
}

}  // namespace

// This function is long because it is the table of all laws.
const std::vector<LocalLawInfo>& all_local_laws() {
  static const std::vector<LocalLawInfo> all{
      {"membrane",
       "A thin elastic sheet that resists stretch, for small local deformation; quadratic in d.",
       "W = t [lambda/2 (tr eps)^2 + mu eps:eps] per area, eps = sym grad d in the plane, lambda = E nu/(1 - "
       "nu^2), mu = E/(2 (1 + nu))",
       true,
       {kYoung, kPoissonShell, kThickness},
       [](const LocalMesh& mesh, const double* values) -> Energy {
         return std::make_unique<LinearMembrane>(shell(mesh), sheet(values));
       },
       true},
      {"st_venant_kirchhoff_membrane",
       "A thin sheet that resists stretch relative to the rest shape, for any rotation.",
       "W = t [lambda/2 (tr G)^2 + mu G:G] per area, G = (C - 1)/2, C = F^T F in the plane, lambda = E nu/(1 "
       "- nu^2), mu = E/(2 (1 + nu))",
       true,
       {kYoung, kPoissonShell, kThickness},
       membrane_energy<StVenantKirchhoffSheet>},
      {"neo_hookean_membrane",
       "A rubber sheet that resists stretch relative to the rest shape, for any rotation.",
       "W = t mu/2 [tr C - 2 + (D^-k - 1)/k] per area, D = det C, C = F^T F in the plane, k = nu/(1 - nu), "
       "mu = E/(2 (1 + nu)); Blatz & Ko 1962 in plane stress",
       true,
       {kYoung, kPoissonShell, kThickness},
       membrane_energy<NeoHookeanSheet>},
      {"neo_hookean_log_membrane",
       "A sheet of classical compressible neo-Hookean rubber in plane stress, for any rotation. A step ends "
       "the run if it gives a triangle no area.",
       "W = t min over s of [mu/2 (tr C + s - 3) - mu ln J + lambda/2 (ln J)^2] per area, J^2 = s det C, C = "
       "F^T F in the plane, lambda = E nu/((1 + nu)(1 - 2 nu)), mu = E/(2 (1 + nu))",
       true,
       {kYoung, kPoissonLogShell, kThickness},
       membrane_energy<NeoHookeanLogSheet>},
      {"loaded_membrane",
       "The membrane of Terzopoulos & Metaxas 1991 over the surface.",
       "W = 1/2 (w1 |grad d|^2 + w0 |d|^2) per area",
       true,
       {{"w0", "N/m^3", "Resists the size of d.", 0, false, 0.0},
        {"w1", "N/m", "Resists the variation of d.", 0, false}},
       [](const LocalMesh& mesh, const double* values) -> Energy {
         return std::make_unique<LoadedMembrane>(shell(mesh), Load{values[0], values[1]});
       },
       true},
      {"loaded_membrane_uv",
       "The membrane of Terzopoulos & Metaxas 1991 over the rectangle of the parameters u and v, as "
       "published: stiffer towards poles.",
       "W = 1/2 (w1 |grad d|^2 + w0 |d|^2) per du dv",
       true,
       {{"w0", "N/m", "Resists the size of d.", 0, false, 0.0},
        {"w1", "N/m", "Resists the variation of d.", 0, false}},
       [](const LocalMesh& mesh, const double* values) -> Energy {
         return std::make_unique<LoadedMembrane>(parameter_mesh(mesh), Load{values[0], values[1]});
       },
       true},
      {"bending",
       "A thin sheet that resists bending, for small local deformation; quadratic in d.",
       "W = D/2 [nu (tr k)^2 + (1 - nu) k:k] per area, k: curvature, linear in d; D = E t^3/(12 (1 - nu^2))",
       true,
       {kYoung, kPoissonShell, kThickness},
       bending_energy<LinearHinges>,
       true},
      {"folding",
       "A thin sheet that resists bending relative to the rest shape, for any rotation.",
       "W = D/2 [nu (tr k)^2 + (1 - nu) k:k] per area, k: change of curvature from exact angles between "
       "triangles, for any number of turns; D = E t^3/(12 (1 - nu^2))",
       true,
       {kYoung, kPoissonShell, kThickness},
       bending_energy<FoldingHinges>},
      {"pressure",
       "A constant excess pressure in the shell.",
       "E = -p V, V: volume of the shell",
       true,
       {{"p", "Pa", "Pressure inside minus pressure outside.", -std::numeric_limits<double>::infinity(),
         true}},
       [](const LocalMesh& mesh, const double* values) -> Energy {
         return std::make_unique<ConstantPressure>(shell(mesh), values[0]);
       }},
      {"gas",
       "A gas in the shell: p V^gamma is constant.",
       "E = p0 V0/(gamma - 1) (V0/V)^(gamma - 1) + p_ext V; for gamma = 1 p0 V0 log(V0/V) + p_ext V",
       true,
       {{"p0", "Pa", "Pressure in the shell at rest.", 0, false},
        {"gamma", "1", "Ratio of the specific heats of the gas; 1 means constant temperature.", 1, false,
         1.4},
        {"p_ext", "Pa", "Pressure outside.", 0, false, 0.0}},
       [](const LocalMesh& mesh, const double* values) -> Energy {
         VecX<double> X(3 * mesh.X.rows());
         X << mesh.X.col(0), mesh.X.col(1), mesh.X.col(2);
         const double V0 = ConstantPressure(shell(mesh), 0).volume(X);
         return std::make_unique<GasPressure>(shell(mesh), Gas{values[0], V0, values[1], values[2]});
       }},
      {"elastic",
       "Linear elasticity, for small local deformation; quadratic in d.",
       "W = lambda/2 (tr eps)^2 + mu eps:eps, eps = sym grad d, lambda = E nu/((1 + nu)(1 - 2 nu)), mu = "
       "E/(2 (1 + nu))",
       false,
       {kYoung, kPoissonSolid},
       solid_energy<SolidLaw::linear>,
       true},
      {"elastic_averaged",
       "Linear elasticity with the dilatation averaged around nodes, which does not lock for nu near 1/2.",
       "W = mu eps:eps + lambda/2 theta^2, eps = sym grad d, theta: mean of tr eps over patches, lambda = E "
       "nu/((1 + nu)(1 - 2 nu)), mu = E/(2 (1 + nu))",
       false,
       {kYoung, kPoissonSolid},
       solid_energy<SolidLaw::averaged_linear>,
       true},
      {"st_venant_kirchhoff",
       "St. Venant-Kirchhoff elasticity, with strain relative to the rest shape, for any rotation.",
       "W = lambda/2 (tr G)^2 + mu G:G, G = (F^T F - 1)/2, lambda = E nu/((1 + nu)(1 - 2 nu)), mu = E/(2 (1 "
       "+ nu))",
       false,
       {kYoung, kPoissonSolid},
       solid_energy<SolidLaw::st_venant_kirchhoff>},
      {"neo_hookean",
       "Rubber without a logarithm in its energy: elements may be inverted, and the forces turn them back.",
       "W = mu/2 (F:F - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2, J = det F, lambda = E nu/((1 + nu)(1 - "
       "2 nu)), mu = E/(2 (1 + nu)); Smith, de Goes & Kim 2018 without their logarithm",
       false,
       {kYoung, kPoissonSolid},
       solid_energy<SolidLaw::neo_hookean>},
      {"neo_hookean_log",
       "Classical compressible neo-Hookean rubber, for any rotation. A step that inverts an element ends the "
       "run.",
       "W = mu/2 (F:F - 3) - mu ln J + lambda/2 (ln J)^2, J = det F > 0, lambda = E nu/((1 + nu)(1 - 2 nu)), "
       "mu = E/(2 (1 + nu))",
       false,
       {kYoung, kPoissonLogSolid},
       solid_energy<SolidLaw::neo_hookean_log>},
      {"corotated",
       "Linear elasticity in a frame that turns with each element.",
       "W = mu |F - R|^2 + lambda/2 (tr S - 3)^2, F = R S, R: rotation, lambda = E nu/((1 + nu)(1 - 2 nu)), "
       "mu = E/(2 (1 + nu))",
       false,
       {kYoung, kPoissonSolid},
       solid_energy<SolidLaw::corotated>},
  };
  return all;
}

const LocalLawInfo& local_law_info(const std::string& name) {
  for (const LocalLawInfo& info : all_local_laws())
    if (name == info.name) return info;
  throw std::logic_error("no law '" + name + "'");
}

LocalSettings::Law local_law(const std::string& name, std::vector<double> values) {
  std::string known;
  for (const LocalLawInfo& info : all_local_laws()) {
    known += std::string(" ") + info.name;
    if (name != info.name) continue;
    if (values.size() != info.numbers.size())
      throw std::invalid_argument("law '" + name + "' has " + std::to_string(info.numbers.size()) +
                                  " numbers, not " + std::to_string(values.size()));
    const bool of_shell = info.shell;
    const auto make_energy = info.make_energy;
    std::optional<Elasticity> linear;
    if (name == "elastic") linear.emplace(values[0], values[1]);
    return LocalSettings::Law(
        [name, of_shell, make_energy, values = std::move(values)](const LocalMesh& mesh) {
          if (mesh.shell() != of_shell)
            throw std::invalid_argument("law '" + name + "' is for " + (of_shell ? "shells" : "solids") +
                                        ", not for " + (of_shell ? "solids" : "shells"));
          return make_energy(mesh, values.data());
        },
        name, linear);
  }
  throw std::invalid_argument("no law of local deformation '" + name + "'; there are:" + known);
}

}  // namespace pliant
