/** The panels: what is not needed to see the state of the robot and to stop it. */

import "/web/js/map/map.js";
import "/web/js/task/task_strip.js";
import "/web/js/inspector/why.js";
import "/web/js/inspector/part_panel.js";
import "/web/js/signals/pending_list.js";
import "/web/js/signals/signal_list.js";
import "/web/js/timeline/timeline.js";
