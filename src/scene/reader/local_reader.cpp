#include "local_reader.h"

#include <algorithm>
#include <cmath>

#include <pliant/part/local/local_laws.h>

namespace pliant {

namespace {

/// A Gaussian initial displacement and velocity around a centre.
struct Dent {
  Vec3<double> at, displacement, velocity;
  double radius;
  double share(const Vec3<double>& X) const { return std::exp(-((X - at) / radius).squaredNorm()); }
};

/// Reads the basis of a local deformation and the keys of this basis into `settings`.
void read_basis(const Reader& local, SceneFaults& faults, const Part& part, LocalSettings& settings) {
  using Basis = LocalSettings::Basis;
  const std::string name = local.text("basis");
  settings.basis = name == "polynomial" ? Basis::polynomial : name == "modes" ? Basis::modes : Basis::nodes;
  settings.degree = static_cast<int>(local.integer("degree"));
  settings.modes = static_cast<int>(local.integer("modes"));
  if (settings.basis == Basis::polynomial && part.shell())
    faults.place(local.at("basis"),
                 "the basis \"polynomial\" is for solids, and the part is a shell; expected \"nodes\" or "
                 "\"modes\"");
  const auto only = [&](const char* key, Basis basis, const char* basis_name) {
    if (local.given(key) && settings.basis != basis)
      faults.place(local.at(key), std::string("this key is for the basis \"") + basis_name +
                                      "\", and the basis is \"" + name + "\"; expected no \"" + key + "\"");
  };
  only("degree", Basis::polynomial, "polynomial");
  only("modes", Basis::modes, "modes");
  if (local.given("order") && settings.basis == Basis::polynomial)
    faults.place(local.at("order"), "the basis \"polynomial\" has no elements; expected no \"order\"");
}

/// Returns whether a basis can be used with a law; reports a fault if not.
bool accepts(const LocalSettings& settings, const LocalLawInfo& info, const Reader& law,
             SceneFaults& faults) {
  using Basis = LocalSettings::Basis;
  if (settings.basis == Basis::nodes) return true;
  if (settings.basis == Basis::modes ? info.quadratic : std::string(info.name) == "elastic") return true;
  faults.place(law.json(),
               std::string("the law '") + info.name + "' is not " +
                   (settings.basis == Basis::modes ? "quadratic in d, which the basis \"modes\" needs"
                                                   : "'elastic', which the basis \"polynomial\" needs") +
                   "; expected the basis \"nodes\", or another law");
  return false;
}

}  // namespace

void read_local(const Reader& local, const MakeSparseFactor& make_factor, SceneFaults& faults, Part& part) {
  const std::size_t before = faults.errors();
  LocalSettings settings;
  settings.make_factor = make_factor;
  settings.resolution = static_cast<int>(local.integer("resolution"));
  settings.order = static_cast<int>(local.integer("order"));
  read_basis(local, faults, part, settings);
  settings.alpha = local.number("alpha");
  settings.beta = local.number("beta");
  if (part.shell() && local.given("order"))
    faults.place(local.at("order"), "the elements of a shell have no order; expected no \"order\"");
  for (const Reader& law : local.objects("laws")) {
    const auto info = std::find_if(all_local_laws().begin(), all_local_laws().end(),
                                   [&](const LocalLawInfo& i) { return i.name == law.name(); });
    if (info == all_local_laws().end() || !law.complete()) continue;
    if (info->shell != part.shell()) {
      faults.place(law.json(), std::string("this law is for ") + (info->shell ? "shells" : "solids") +
                                   ", and the part is a " + (part.shell() ? "shell" : "solid") +
                                   (info->shell ? "; expected \"shell\": true" : ""));
      continue;
    }
    if (!accepts(settings, *info, law, faults)) continue;
    std::vector<double> values;
    for (const LocalLawInfo::Number& n : info->numbers) values.push_back(law.number(n.key));
    settings.energies.push_back(local_law(info->name, std::move(values)));
  }
  std::vector<Dent> dents;
  for (const Reader& dent : local.objects("dents"))
    if (dent.complete())
      dents.push_back({dent.vector3("at"), dent.vector3("displacement"), dent.vector3("velocity"),
                       dent.number("radius")});
  if (!dents.empty()) {
    auto sum_of = [dents](Vec3<double> Dent::*which) {
      return [dents, which](const Vec3<double>& X) {
        Vec3<double> sum = Vec3<double>::Zero();
        for (const Dent& dent : dents) sum += dent.share(X) * dent.*which;
        return sum;
      };
    };
    settings.displacement = sum_of(&Dent::displacement);
    settings.velocity = sum_of(&Dent::velocity);
  }
  if (faults.errors() == before) part.deform_locally(std::move(settings));
}

}  // namespace pliant
