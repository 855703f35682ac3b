// The studio's page.

import "./studio.css";
