// The registry of shapes and deformations.
#include <pliant/part/registry.h>

#include <stdexcept>
#include <utility>

#include <pliant/deform/all_deforms.h>

#include "part/instances/primitive_factory.h"

namespace pliant {

namespace {

template <class... Shapes>
std::vector<std::unique_ptr<ShapeInterface>> faces_of(std::tuple<Shapes...>*) {
  std::vector<std::unique_ptr<ShapeInterface>> all;
  (all.push_back(std::make_unique<ShapeInterfaceOf<Shapes>>()), ...);
  return all;
}

template <class... Deforms>
std::vector<DeformationInfo> deformations_of(std::tuple<Deforms...>*) {
  return {{Deforms::name, Deforms::formula, {Deforms::parameters.begin(), Deforms::parameters.end()}}...};
}

template <class... Deforms>
std::shared_ptr<const AnyLink> make_link(const std::string& name, std::tuple<Deforms...>*) {
  std::shared_ptr<const AnyLink> link;
  ((name == Deforms::name ? void(link = std::make_shared<AnyLinkOf<Deforms>>()) : void()), ...);
  return link;
}

template <int... I>
std::unique_ptr<Part> make_shape(const std::string& shape, const std::string& name, double density,
                                 AnyChain chain, std::integer_sequence<int, I...>) {
  std::unique_ptr<Part> part;
  ((shape == std::tuple_element_t<I, AllShapes>::name
        ? void(part = make_primitive<I>(name, density, std::move(chain)))
        : void()),
   ...);
  return part;
}

}  // namespace

const std::vector<std::unique_ptr<ShapeInterface>>& all_shapes() {
  static const std::vector<std::unique_ptr<ShapeInterface>> all = faces_of(static_cast<AllShapes*>(nullptr));
  return all;
}

const std::vector<DeformationInfo>& all_deformations() {
  static const std::vector<DeformationInfo> all = deformations_of(static_cast<AllDeforms*>(nullptr));
  return all;
}

std::unique_ptr<Part> make_part(const std::string& name, const std::string& shape,
                                const std::vector<std::string>& deformations, double density) {
  std::vector<std::shared_ptr<const AnyLink>> links;
  for (const std::string& deformation : deformations) {
    links.push_back(make_link(deformation, static_cast<AllDeforms*>(nullptr)));
    if (links.back()) continue;
    std::string names;
    for (const DeformationInfo& info : all_deformations())
      names += std::string(names.empty() ? "" : " ") + info.name;
    throw std::invalid_argument("part '" + name + "': no deformation '" + deformation +
                                "'; there are: " + names);
  }
  auto part = make_shape(shape, name, density, AnyChain(std::move(links)),
                         std::make_integer_sequence<int, std::tuple_size_v<AllShapes>>());
  if (!part) {
    std::string names;
    for (const auto& face : all_shapes()) names += std::string(names.empty() ? "" : " ") + face->name();
    throw std::invalid_argument("part '" + name + "': no shape '" + shape + "'; there are: " + names);
  }
  return part;
}

}  // namespace pliant
