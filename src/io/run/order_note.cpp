#include <pliant/io/run/order_note.h>

#include <pliant/io/format/number_text.h>

namespace pliant {

std::string order_note(const RunRecord& record, int order) {
  constexpr double kSmall = 0.01;
  if (order != 1 || record.tolerance > 0 || !(record.max_kinetic > 0)) return "";
  const double share = record.max_balance_error / record.max_kinetic;
  const std::string text = record.integrator +
                           " is a method of first order: the largest error of the energy " + "balance is " +
                           rounded_text(100 * share, 2) + " % of the largest kinetic energy";
  if (!(share > kSmall)) return text;
  return "warning: " + text + "; steps of about " + rounded_text(record.step * kSmall / share, 2) +
         " s, or the integrator \"auto\", reduce it to 1 % or less";
}

}  // namespace pliant
