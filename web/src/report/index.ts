// What a report does where scripts run: its tables are copied and saved. Without scripts, and in print, it is all there too.

import { addTools } from "./tables";

addTools();
