#include "ringbus/stress/queue_under_test.h"

#include "core/types/added_names.h"
#include "ringbus/queues/queue_design.h"
#include "ringbus/queues/queue_types.h"

namespace carousel::ringbus::stress {

QueueUnderTest named_queue(QueueKind kind) {
  const std::string name(enum_name(kind));
  if (const auto* own = added_body<QueueDesign>(kind)) return own->under_test(name);
  return with_queue_type(kind, [&](auto type) { return queue_under_test<decltype(type)::template Of>(name); });
}

}  // namespace carousel::ringbus::stress
