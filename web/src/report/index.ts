// What a report does where scripts run: its tables are copied and saved, its pictures of motions play, its curves are read. Without scripts, and in print, it is all there too.

import { addPlays, joinViewers } from "./play";
import { addReadings } from "./read";
import { addTools, fadeEdges } from "./tables";

addTools();
fadeEdges();
addPlays();
joinViewers();
addReadings();
