#include <pliant/io/run/skipped.h>

namespace pliant {

std::vector<std::string> skipped_work(const Model& model) {
  int fixed = 0, prescribed = 0, rigid = 0, frozen = 0, moving = 0, local = 0;
  for (const PartModel& part : model.parts()) {
    if (part.q0 < 0) {
      ++(part.motion != nullptr ? prescribed : fixed);
      continue;
    }
    ++moving;
    if (part.local != nullptr) ++local;
    if (part.part->rigid())
      ++rigid;
    else if (part.n_s > 0)
      frozen += part.part->parameters().size() - part.n_s;
  }
  std::vector<std::string> skipped;
  if (fixed > 0) skipped.push_back("coordinates of fixed parts: " + std::to_string(fixed));
  if (prescribed > 0)
    skipped.push_back("coordinates of parts with prescribed motion: " + std::to_string(prescribed));
  if (rigid > 0)
    skipped.push_back("Jacobians of rigid parts, whose inertia is constant: " + std::to_string(rigid));
  if (frozen > 0)
    skipped.push_back("rows and columns of M for frozen parameters of deformable parts: " +
                      std::to_string(frozen));
  if (moving > 0 && local == 0)
    skipped.push_back("meshes and elements, because no part has local deformation");
  if (local > 0 && local < moving)
    skipped.push_back("meshes and elements of parts without local deformation: " +
                      std::to_string(moving - local));
  if (model.joints().empty())
    skipped.push_back("constraint Jacobians and multipliers, because there are no joints");
  if (moving > 1 && model.load_connections().empty() && model.joints().empty())
    skipped.push_back("coupled equations of the parts, because no load or joint connects them");
  if (model.load_connections().empty() && model.loaded_parts().empty())
    skipped.push_back("springs, forces, torques and drives, because there are none");
  if (model.body().gravity.isZero(0)) skipped.push_back("gravity, because it is zero");
  return skipped;
}

}  // namespace pliant
